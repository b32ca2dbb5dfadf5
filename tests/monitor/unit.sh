#!/usr/bin/env bash
# unit.sh GOINGRATE SOURCE: the guide's systemd unit as printed there. Its command is run with the words into which
# systemd splits it, on a pipe instead of the serial line; then systemd checks the unit, if it is installed.
set -euo pipefail
goingrate=$1 source=$2
work=$(mktemp -d)
trap 'kill $(jobs -p) 2> /dev/null || true; rm -rf "$work"' EXIT
cd "$work"
awk '/^```ini/ { inside = 1; next } /^```/ { inside = 0 } inside' "$source/data/guide/monitor.md" > told
sed "s|/usr/bin/goingrate|$goingrate|" told > goingrate.service
[ "$(grep -c "^ExecStart=$goingrate" goingrate.service)" = 1 ] || { echo "not ok the guide has a unit"; exit 1; }

mkdir bin
printf '#!/bin/sh\n{ printf "%%s|" "$@"; cat; } >> "%s/mails"\n' "$work" > bin/mail
chmod +x bin/mail
mkfifo line
PATH=$work/bin:$PATH python3 - <<'PY' &
import os, shlex
unit = open("goingrate.service").read().replace("\\\n", " ")
command = next(line for line in unit.splitlines() if line.startswith("ExecStart="))[len("ExecStart="):]
words = [word.replace("$$", "$") for word in shlex.split(command)]
places = {"/dev/ttyACM0:115200": "line", "/var/lib/clock": "clock", "127.0.0.1:8080": "127.0.0.1:0"}
assert all(place in words for place in places), words
os.execv(words[0], [places.get(word, word) for word in words])
PY
monitor=$!
exec 3> line
{ printf '# goingrate log: 1\n# nominal_period_s: 1\ntime_s\n'; seq 0 19; } >&3
for ((tenth = 0; tenth < 300; ++tenth)); do # a busy computer's half minute
  [ -s mails ] && break
  sleep 0.1
done
if grep -q '^-s|Hall clock: stopped raised|you@example.org|no beat for' mails; then
  echo "ok its command archives, and mails the alarm"
else
  echo "not ok its command archives, and mails the alarm: $(cat mails 2> /dev/null)"
  exit 1
fi
kill $monitor
wait $monitor || { echo "not ok it ends by SIGTERM, as systemd stops it"; exit 1; }
echo "ok it ends by SIGTERM, as systemd stops it"

command -v systemd-analyze > /dev/null || { echo "no systemd-analyze here: the unit is not verified"; exit 77; }
said=$(systemd-analyze verify ./goingrate.service 2>&1) || { echo "not ok systemd-analyze verify: $said"; exit 1; }
[ -z "$said" ] || { echo "not ok systemd-analyze verify says: $said"; exit 1; }
echo "ok systemd-analyze verify"
