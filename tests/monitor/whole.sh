#!/usr/bin/env bash
# A monitor as a process: killed, its disk full, its source a pipe, a terminal, a file that is rotated; what it
# serves. Argument: the command.
set -euo pipefail
goingrate=$(realpath -e "$1") # whose absence would leave a pipe without a reader
work=$(mktemp -d)
trap 'kill $(jobs -p) 2> /dev/null || true; rm -rf "$work"' EXIT
cd "$work"
fault=0
check() { # words, then a command that must succeed
  local words=$1
  shift
  if "$@"; then echo "ok $words"; else
    echo "not ok $words"
    fault=1
  fi
}
beats() { # of a clock that loses 3 ppm, from N to M, the times 60 times as fast as they come
  awk -v from="$1" -v to="$2" 'BEGIN { for (n = from; n < to; ++n) printf "%.6f\n", n * 1.000003 }'
}
rows() { cat "$1"/*.csv 2> /dev/null | grep -c '^[0-9]' || true; }
has_rows() { [ "$(rows "$1")" -ge "$2" ]; }
within() { # seconds, then a command: tried until it succeeds
  local left=$(($1 * 10))
  shift
  until "$@"; do
    [ $((left--)) -gt 0 ] || return 1
    sleep 0.1
  done
}

# Killed while it listens to a pipe: what had come two seconds before is there, and the count goes on.
mkfifo pipe
"$goingrate" --quiet monitor pipe --archive killed &
monitor=$!
exec 3> pipe
{ printf '# goingrate log: 1\n# nominal_period_s: 1\ntime_s\n'; beats 0 500; } >&3
sleep 3
kill -9 $monitor
wait $monitor 2> /dev/null || true
exec 3>&-
check "kill -9 loses nothing that was acknowledged" has_rows killed 500
printf '1764201' >> "$(ls killed/*.csv | tail -n 1)" # a line that a failure of power tore
"$goingrate" --quiet monitor pipe --archive killed --listen 127.0.0.1:0 2> said &
monitor=$!
exec 3> pipe
{ printf '# goingrate log: 1\n# nominal_period_s: 1\ntime_s\n'; beats 600 900; } >&3
check "it goes on in the same files" within 20 has_rows killed 800
kill -TERM $monitor
exec 3>&-
check "a signal ends it" within 10 bash -c "! kill -0 $monitor 2> /dev/null"
check "the archive is a log" bash -c "'$goingrate' --quiet rate killed -o table.csv"
check "of 900 cycles" grep -q '^899,' table.csv

# Lines of no known layout yet: too few of them to tell, killed, and the next run goes on with them.
mkfifo bare
"$goingrate" --quiet monitor bare --archive early &
monitor=$!
exec 3> bare
beats 0 5 >&3
check "lines that are not recognised yet are kept" within 20 bash -c '[ "$(grep -c . early/.unread)" = 5 ]'
kill -9 $monitor
wait $monitor 2> /dev/null || true
exec 3>&-
"$goingrate" --quiet monitor bare --archive early &
monitor=$!
exec 3> bare
beats 5 20 >&3
check "and are events after a kill -9" within 20 has_rows early 20
check "once" within 20 test ! -e early/.unread
kill $monitor
check "it ends well" wait $monitor
exec 3>&-

# What a source tells beside the time is in the archive, also when it told its columns before a kill -9 only, and a
# report uses it.
mkfifo gate
told() { # from N to M, of a clock that loses 10 ppm a degree
  awk -v from="$1" -v to="$2" 'BEGIN { t = from; for (n = from; n < to; ++n) { c = 20 + 2 * sin(n / 300)
    printf "%.6f,%.6f,%.2f,1013.2\n", t - 0.002 + 1e-5 * 600 * (1 - cos(n / 300)), 0.004, c; t += 1 } }'
}
"$goingrate" --quiet monitor gate --archive beside &
monitor=$!
exec 3> gate
{ printf '# goingrate log: 1\n# nominal_period_s: 1\ntime_s,width_s,temperature_c,pressure_mbar\n'; told 0 3000; } >&3
check "rows with columns" within 20 has_rows beside 3000
kill -9 $monitor
wait $monitor 2> /dev/null || true
exec 3>&-
"$goingrate" --quiet monitor gate --archive beside &
monitor=$!
exec 3> gate
told 3000 6000 >&3
check "and after a kill -9" within 20 has_rows beside 6000
kill $monitor
check "it ends well" wait $monitor
exec 3>&-
check "all have them" [ "$(cat beside/*.csv | grep -cE '^[0-9.]+,up,0.004000000,,(1|2)[0-9.]+,1013.2$')" = 6000 ]
"$goingrate" --quiet report beside -o beside.html > beside.txt
check "and a report finds the 10 ppm a degree" grep -q 'falls by 86[34].*per kelvin' beside.txt

# A FIFO whose writer has gone is a clock that is silent, and no writer at all is no reason to hang.
mkfifo lonely
"$goingrate" monitor lonely --archive lonely.d --patience 1 2> lonely.said &
monitor=$!
sleep 0.5
{ printf '# goingrate log: 1\n# nominal_period_s: 1\ntime_s\n'; beats 0 20; } > lonely
check "its writer has gone, and the clock is called stopped" within 20 grep -q "alarm stopped" lonely.said
kill $monitor
check "and a signal ends it" within 10 bash -c "! kill -0 $monitor 2> /dev/null"
beats 0 100000000 | "$goingrate" --quiet monitor - --archive flood.d &
monitor=$!
sleep 2
kill $monitor
check "a signal ends it in a flood of lines" within 10 bash -c "! kill -0 $monitor 2> /dev/null"

# A sound card whose monitor is killed: nothing keeps the archive.
mkdir card
printf '#!/bin/sh\nexec cat /dev/zero\n' > card/arecord
chmod +x card/arecord
PATH=$PWD/card:$PATH "$goingrate" --quiet monitor arecord:hw:1 --archive heard.d &
monitor=$!
sleep 1
kill -9 $monitor
wait $monitor 2> /dev/null || true
PATH=$PWD/card:$PATH "$goingrate" --quiet monitor arecord:hw:1 --archive heard.d &
monitor=$!
sleep 1
check "after kill -9 the next one listens" kill -0 $monitor
kill $monitor
check "until a signal" within 10 bash -c "! kill -0 $monitor 2> /dev/null"

# A command of an alarm does not read the beats.
{ beats 0 50; sleep 2; beats 60 100; } | "$goingrate" --quiet monitor - --archive kept.d --patience 1 --on-alarm cat > stolen
check "an alarm's command has nothing to read" test ! -s stolen

# What it serves.
python3 - "$goingrate" <<'PY' || fault=1
import atexit, glob, http.client, json, os, re, socket, subprocess, sys, time
command = sys.argv[1]
fault = 0
def check(words, holds):
    global fault
    print(("ok " if holds else "not ok ") + words)
    fault |= not holds
master, slave = os.openpty()
os.set_blocking(master, True)
process = subprocess.Popen([command, "monitor", os.ttyname(slave) + ":115200", "--archive", "served", "--listen",
                            "127.0.0.1:0", "--name", "<b>Hall & \"Dial\"</b>", "--patience", "2", "--on-alarm",
                            "echo $GOINGRATE_ALARM $GOINGRATE_STATE >> alarms"], stderr=subprocess.PIPE, text=True)
atexit.register(process.kill)
port = int(re.search(r"port (\d+)", process.stderr.readline()).group(1))
def get(path, method="GET", body=None, host=None):
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    link.request(method, path, body, {"Host": host} if host else {})
    answer = link.getresponse()
    return answer.status, answer.read().decode(), answer.headers
os.write(master, b"# goingrate log: 1\n# nominal_period_s: 0.5\ntime_s\n")
start = time.time()
for n in range(20):
    os.write(master, b"%.6f\n" % (n * 0.5))
deadline = time.time() + 20
while time.time() < deadline and json.loads(get("/api/now")[1])["acknowledged"] < 20:
    time.sleep(0.2)
now = json.loads(get("/api/now")[1])
check("a serial line is read", now["beats"] == 20)
check("all is acknowledged", now["acknowledged"] == 20 and now["heard"] == 20)
check("the name is as given", now["clock"] == '<b>Hall & "Dial"</b>')
status, page, headers = get("/")
check("the page is served under a policy", status == 200 and "default-src 'none'" in headers["Content-Security-Policy"])
check("and does not hold the name, which is asked for", "Hall" not in page)
for path in ("minutes", "hours", "days", "alarms", "breaks"):
    check("/api/" + path, isinstance(json.loads(get("/api/" + path)[1])["rows"], list))
check("metrics", "\ngoingrate_beats_total 20\n" in get("/metrics")[1])
for path in ("/../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/api/../../alarms", "/served", "/api/now/x"):
    check("no way to files: " + path, get(path)[0] == 404)
for host in ("attacker.example", "attacker.example:%d" % port, "127.0.0.1.attacker.example"):
    check("no page of the web by a name of its own: " + host, get("/api/now", host=host)[0] == 403)
for host in ("localhost:%d" % port, "[::1]:%d" % port):
    check("but by this computer's: " + host, get("/api/now", host=host)[0] == 200)
check("nothing is taken", get("/api/now", "POST", "x")[0] in (404, 405) and get("/api/now", "PUT", "x")[0] in (404, 405))
slow = [socket.create_connection(("127.0.0.1", port)) for _ in range(30)]  # that never ask
waited = time.time()
check("thirty that say nothing leave it answering", get("/api/now")[0] == 200 and time.time() - waited < 10)
for link in slow:
    link.close()
listeners = []
for _ in range(20):
    link = socket.create_connection(("127.0.0.1", port), timeout=10)
    link.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
    listeners.append(link)
began = time.time()
check("and twenty that listen", get("/api/now")[0] == 200)
first = listeners[0].recv(4096).decode(errors="replace")
check("events are sent", "text/event-stream" in first)
for link in listeners:
    link.close()
crowd = [socket.create_connection(("127.0.0.1", port), timeout=2) for _ in range(120)]
for link in crowd:  # each sends a byte of a request now and then
    link.sendall(b"G")
for n in range(20, 40):
    os.write(master, b"%.6f\n" % (n * 0.5))
deadline, rows = time.time() + 20, 0
while time.time() < deadline and rows < 40:
    time.sleep(0.2)
    rows = sum(line[0].isdigit() for name in glob.glob("served/*.csv") for line in open(name))
check("a crowd that says little does not stop the archive: %d rows" % rows, rows == 40)
deadline = time.time() + 20
said = ""
while time.time() < deadline and not said:
    time.sleep(0.2)
    said = open("alarms").read() if os.path.exists("alarms") else ""
check("a command is run when the clock stops", said.startswith("stopped raised\n"))
def parent(stat):
    try:
        return re.sub(r".*\)", "", open(stat).read()).split()[1]
    except (FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
        return None
check("and leaves no process behind", str(process.pid) not in map(parent, glob.glob("/proc/[0-9]*/stat")))
process.terminate()
process.wait(timeout=15)
check("it ends when asked", process.returncode == 0)
sys.exit(fault)
PY

# A disk that is full: what is in the file are whole lines, and the alarm is told.
(
  ulimit -f 64
  beats 0 20000 | "$goingrate" monitor - --archive full 2> full.said
) || true
check "a full disk leaves whole lines" bash -c "tail -c 1 full/*.csv | od -c | grep -q '\\\\n'"
check "and is told" grep -q archive-failing full.said

# A file that is rotated.
beats 0 100 > growing.log
"$goingrate" --quiet monitor growing.log --archive rotated --start 1764201600 &
monitor=$!
check "a file" within 20 has_rows rotated 100
mv growing.log growing.1
beats 100 200 > growing.log
check "and the one after it" within 20 has_rows rotated 200
kill $monitor
check "it ends well" wait $monitor
check "by its day" test -s rotated/2025-11-27.csv
beats 200 250 >> growing.log # while no monitor runs
mv growing.log growing.log.1
beats 250 300 > growing.log
"$goingrate" --quiet monitor growing.log --archive rotated --start 1764201600 &
monitor=$!
check "what was rotated while it was down is read first" within 20 has_rows rotated 300
kill $monitor
check "it ends well" wait $monitor
check "once" test "$(rows rotated)" = 300

# Two monitors of one archive.
"$goingrate" --quiet monitor growing.log --archive rotated --start 1764201600 &
beats 300 400 >> growing.log
check "one keeps it" within 20 has_rows rotated 400
"$goingrate" monitor - --archive rotated < growing.log 2> refused && fault=1
check "another process is told so" grep -q "another process is writing to this archive" refused
exit $fault
