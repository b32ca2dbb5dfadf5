#!/usr/bin/env bash
# Prints what the surroundings of a clock do to it, as a report tells it: the share of the tide in half-hourly phases
# of two years and on an ordinary clock, a rod whose compensation lags, and the barometer's two ways; how often the
# intervals hold. Arguments: first seed (1), logs of each kind (40).
set -e
. "$(dirname "$0")/common.sh"
built study_conditions
head_line "${1:-1}"
build/bench/study_conditions "${1:-1}" "${2:-40}"
