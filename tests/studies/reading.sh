#!/usr/bin/env bash
# Reads and numbers a year of a seconds pendulum (15.8 million lines) beside numpy.loadtxt on the same
# file; reading.txt holds two such prints, which differ by the machine's memory. Takes about two minutes once built.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup python3-numpy
built study_reading
log=$(mktemp)
trap 'rm -f "$log"' EXIT
head_line
build/bench/study_reading write "$log" 15800000
build/bench/study_reading read "$log"
/usr/bin/python3 - "$log" << 'PYTHON'
import sys, time, numpy
begin = time.process_time()
times = numpy.loadtxt(sys.argv[1])
took = time.process_time() - begin
print(f"numpy.loadtxt (numpy {numpy.__version__}) {took:.2f} s, {len(times)} numbers of 0.24 us resolution")
PYTHON
