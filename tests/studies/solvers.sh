#!/usr/bin/env bash
# Prints the figures of the solvers, and the chart of speed against accuracy. Takes some minutes.
set -e
. "$(dirname "$0")/common.sh"
built study_solvers goingrate_chart
head_line
build/bench/study_solvers
echo
build/bench/goingrate_chart
