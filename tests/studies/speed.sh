#!/usr/bin/env bash
# Usage: speed.sh [LARGEST]
# CPU time and memory of every main job on logs of 10^3 beats to LARGEST beats (default 10^6), compared with
# programs that a user of numpy, pandas and scipy would write. Each job is a process of its own, and its start is
# included. speed.txt holds the output of a run. Takes about ten minutes once built, an hour up to 10^7 beats.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup python3-numpy python3-pandas python3-scipy
built goingrate_command
head_line
/usr/bin/python3 tests/studies/speed.py build/bench/goingrate "${1:-1000000}"
