#!/usr/bin/env bash
# CPU time and memory of every main job at 10^3 beats up to speed.sh [LARGEST], 10^6 if not given, beside what a
# user of numpy, pandas and scipy would write; speed.txt holds such a print. Processes are whole, their start
# included. About ten minutes once built, an hour with 10^7.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup python3-numpy python3-pandas python3-scipy
built goingrate_command
head_line
/usr/bin/python3 tests/studies/speed.py build/bench/goingrate "${1:-1000000}"
