#!/usr/bin/env bash
# Prints how often clocks that are watched are called out for nothing, and how long a step of the rate and other faults
# take to be found; then whether counts that are carried over a break are right as often as is told. Arguments: years
# of each clock (4), first seed (1), years of each clock whose every beat is simulated (2), breaks of each length and
# clock (10).
set -e
. "$(dirname "$0")/common.sh"
built study_monitor study_monitor_alarms study_monitor_breaks
head_line "${2:-1}"
build/bench/study_monitor "${1:-4}" "${2:-1}"
echo
build/bench/study_monitor_alarms "${3:-2}" "${2:-1}"
echo
build/bench/study_monitor_breaks "${4:-10}" "${2:-1}"
