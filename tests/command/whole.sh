#!/usr/bin/env bash
# The whole program under outside faults: killed while it writes, a folder or a disk that cannot be written
# to, no locale, Ctrl-C. Reports what this machine cannot test.
# whole.sh GOINGRATE SOURCE
set -uo pipefail
goingrate=$(realpath "$1") source=$(realpath "$2")
here=$(mktemp -d)
mounted=
trap '[ -z "$mounted" ] || umount "$mounted"; rm -rf "$here"' EXIT
cd "$here" || exit 1
scenario=$source/data/scenarios/jump.toml
log=$source/data/logs/jump.csv
faults=0

fault() {
  echo "FAULT: $*"
  faults=$((faults + 1))
}

# Whatever happens, a file that is there is the old one or the new one, whole.
check_kept() { [ "$(cat "$1")" = precious ] || fault "$2: $1 is not the old file any more"; }
check_no_draft() {
  local left
  left=$(find "$1" -name '*.part-*' | head -3)
  [ -z "$left" ] || fault "$2: left behind: $left"
}
check_code() { [ "$1" -eq "$2" ] || fault "$3: exit $1 instead of $2"; }

# As from a terminal: a shell's own background jobs ignore SIGINT, which env undoes.
# Sends a signal to a command while it writes its draft; the third argument is the exit it has then.
interrupt_writing() {
  local signal=$1 wanted=$2 folder=$here/$1
  mkdir "$folder"
  echo precious > "$folder/log.csv"
  env --default-signal=INT "$goingrate" --quiet simulate "$scenario" \
    --set run.periods=1000000000 -o "$folder/log.csv" &
  local child=$! tries=0
  until [ -n "$(find "$folder" -name '*.part-*' -size +1M)" ] || [ $((tries += 1)) -gt 200 ]; do
    sleep 0.05
  done
  [ "$tries" -le 200 ] || fault "$signal: no draft was seen"
  local start=$EPOCHREALTIME
  kill "-$signal" "$child"
  wait "$child"
  check_code $? "$wanted" "$signal while it writes"
  local took=$(((${EPOCHREALTIME/./} - ${start/./}) / 1000))
  [ "$took" -lt 2000 ] || fault "$signal: it took $took ms to end"
  echo "$signal while it writes: ended after $took ms"
  check_kept "$folder/log.csv" "$signal"
}

interrupt_writing KILL 137
interrupt_writing INT 130
check_no_draft "$here/INT" "Ctrl-C while it writes"
interrupt_writing TERM 143
check_no_draft "$here/TERM" "SIGTERM while it writes"

# What kill -9 left behind goes when the same file is written again.
check_left=$(find "$here/KILL" -name '*.part-*' | wc -l)
[ "$check_left" -eq 1 ] || fault "KILL: $check_left drafts were left to be swept"
"$goingrate" --quiet simulate "$scenario" -o "$here/KILL/log.csv" || fault "simulate after KILL"
check_no_draft "$here/KILL" "writing again after KILL"

# SIGTERM while there are many drafts.
mkdir many
"$goingrate" --quiet simulate "$scenario" --set run.periods=20000 --realisations 1000 --threads 1 \
  -o many/log.csv &
child=$! tries=0
until [ "$(find many -name '*.part-*' | wc -l)" -gt 600 ] || [ $((tries += 1)) -gt 1200 ]; do
  sleep 0.05
done
[ "$tries" -le 1200 ] || fault "there never were 600 drafts"
kill -TERM "$child"
wait "$child"
check_code $? 143 "SIGTERM among many drafts"
check_no_draft many "SIGTERM among many drafts"

# Ctrl-C while it computes: a million beats keep a fit busy for long.
"$goingrate" --quiet simulate "$source/data/scenarios/noisy-drive.toml" --set run.periods=1000000 \
  --set drive.slow_rms=0.05 --set drive.slow_time=900 -o long.csv || fault "no log for the fit"
echo precious > fit.json
env --default-signal=INT "$goingrate" --quiet fit long.csv --json fit.json > /dev/null &
child=$!
sleep 1.5
start=$EPOCHREALTIME
kill -INT "$child" 2> /dev/null || fault "the fit was over before it could be interrupted"
wait "$child"
check_code $? 130 "Ctrl-C during a fit"
took=$(((${EPOCHREALTIME/./} - ${start/./}) / 1000))
[ "$took" -lt 2000 ] || fault "Ctrl-C during a fit: it took $took ms to end"
echo "Ctrl-C during a fit: ended after $took ms"
check_kept fit.json "Ctrl-C during a fit"

# A target that cannot be replaced. For root every folder is writable unless its file system is not.
unwritable() {
  local folder=$1 what=$2
  "$goingrate" --quiet rate "$log" -o "$folder/out.csv" --json "$folder/out.json" 2> said.txt
  check_code $? 5 "$what"
  grep -q "cannot write" said.txt || fault "$what: no message"
  [ ! -e "$folder/out.json" ] || fault "$what: one of two files was written"
}
mkdir closed
echo precious > closed/out.csv
chmod 555 closed
if [ "$(id -u)" -ne 0 ]; then
  unwritable closed "a folder without permission"
  check_kept closed/out.csv "a folder without permission"
else
  echo "skipped: as root no folder lacks permission"
fi
chmod 755 closed

mkdir disk
if mount -t tmpfs -o size=64k tmpfs disk 2> /dev/null; then
  mounted=$here/disk
  echo precious > disk/out.csv
  unwritable disk "a full disk"
  check_kept disk/out.csv "a full disk"
  check_no_draft disk "a full disk"
  mount -o remount,ro disk
  unwritable disk "a read-only disk"
  check_kept disk/out.csv "a read-only disk"
else
  echo "skipped: no small disk can be mounted here"
fi
if [ -e /dev/full ]; then
  for command in "rate $log" "report $log -o page.html" "simulate $scenario" "stability $log" "--help"; do
    # shellcheck disable=SC2086
    "$goingrate" --quiet $command > /dev/full 2> said.txt
    check_code $? 5 "$command > /dev/full"
    [ -s said.txt ] || fault "$command > /dev/full: no message"
  done
fi

# A reader that has left has all it wanted.
for command in "rate $log" "simulate $scenario --set run.periods=100000" "stability $log"; do
  # shellcheck disable=SC2086
  { "$goingrate" --quiet $command 2> said.txt; echo $? > code.txt; } | true
  check_code "$(cat code.txt)" 0 "closed pipe: $command"
  [ ! -s said.txt ] || fault "closed pipe: $command: $(cat said.txt)"
done
{ sleep 0.3; "$goingrate" --quiet rate "$log" 2> said.txt; echo $? > code.txt; } | true
check_code "$(cat code.txt)" 0 "a pipe that was closed before"
[ ! -s said.txt ] || fault "a pipe that was closed before: $(cat said.txt)"

# Numbers and texts are the same without a locale, or with one that does not exist.
results() { # FOLDER [environment ...]
  local folder=$1
  shift
  mkdir "$folder"
  env -i PATH="$PATH" "$@" "$goingrate" report "$log" -o "$folder/page.html" --json "$folder/r.json" \
    > "$folder/out.txt" 2> "$folder/err.txt" || fault "report with $*"
  sed -i "s|$folder|FOLDER|g" "$folder/err.txt"
}
results plain LC_ALL=C
results none
results unknown LC_ALL=xx_XX
results german LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8
for other in none unknown german; do
  diff -rq plain "$other" || fault "results differ: locale $other"
done

[ "$faults" -eq 0 ] || exit 1
echo "The whole program keeps what it promises."
