#!/usr/bin/env bash
# Prints how often clocks that are watched are called out for nothing, and how long a step of the rate takes to be
# found. Arguments: years of each clock (4), first seed (1).
set -e
. "$(dirname "$0")/common.sh"
built study_monitor
head_line "${2:-1}"
build/bench/study_monitor "${1:-4}" "${2:-1}"
