#!/usr/bin/env bash
# Prints what a monitor costs: memory over many lines, one in a hundred of them garbled; the share of a processor at a
# beat per second; the longest time from the arrival of a line to its place on disk (with strace). Arguments: millions of
# lines (50), seconds of the other two (120).
set -e
. "$(dirname "$0")/common.sh"
built_command
head_line
cp "$goingrate" "$here/goingrate" # which a build in the meantime does not change
echo "on $(df --output=fstype "$here" | tail -n 1)"
"${PYTHON:-python3}" - "$here/goingrate" "$here" "${1:-50}" "${2:-120}" <<'PY'
import os, re, shutil, signal, subprocess, sys, time
command, folder, millions, seconds = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
os.chdir(folder)

def watch(name, before=()):
    os.mkfifo(name)
    process = subprocess.Popen([*before, command, "--quiet", "monitor", name, "--archive", name + ".d"])
    to = open(name, "w")
    to.write("# goingrate log: 1\n# nominal_period_s: 1\ntime_s\n")
    return process, to

def memory_mb(process):
    return int(re.search(r"VmRSS:\s+(\d+)", open(f"/proc/{process.pid}/status").read())[1]) // 1024

def seconds_used(process):
    fields = open(f"/proc/{process.pid}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

process, to = watch("many")
print("millions of lines, 1 % garbled; MB resident")
part = 100_000
for first in range(0, int(millions * 1e6), part):
    to.write("".join(f"gar{n}bage\n" if n % 100 == 99 else f"{n}.0\n" for n in range(first, first + part)))
    done = first + part
    if done % max(part, int(millions * 1e5)) == 0:
        to.flush()
        print(f"{done / 1e6:7.1f} {memory_mb(process):5d}", flush=True)
process.send_signal(signal.SIGTERM)
process.wait(60)

def beat(to):
    began = time.time()
    for n in range(10**9):
        if time.time() - began > seconds:
            return
        to.write(f"{n}.0\n")
        to.flush()
        time.sleep(max(0.0, began + n + 1 - time.time()))

process, to = watch("slow")
time.sleep(2)
used = seconds_used(process)
beat(to)
print(f"share of a processor at a beat per second: {100 * (seconds_used(process) - used) / seconds:.2f} %")
process.send_signal(signal.SIGTERM)
process.wait(60)

if not shutil.which("strace"):
    sys.exit("strace is not installed")
process, to = watch("traced", ["strace", "-f", "-ttt", "-e", "trace=read,fdatasync", "-o", "trace"])
time.sleep(2)
beat(to)
for child in open(f"/proc/{process.pid}/task/{process.pid}/children").read().split():
    os.kill(int(child), signal.SIGTERM)
process.wait(60)
heard, longest, syncs = None, 0.0, 0
for line in open("trace"):
    _, at, call = line.split(None, 2)
    if re.match(r'read\(\d+, "\d+\.0\\n"', call) and heard is None:
        heard = float(at)
    if call.startswith("fdatasync") and "= 0" in call and heard is not None:
        longest, syncs, heard = max(longest, float(at) - heard), syncs + 1, None
print(f"longest time from a line to its sync: {longest:.2f} s of {syncs}")
PY
