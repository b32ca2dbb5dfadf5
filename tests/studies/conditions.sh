#!/usr/bin/env bash
# Prints what the surroundings of a clock do to it, as a report tells it: the share of the tide in half-hourly phases
# of two years and on an ordinary clock, a rod whose compensation lags, the barometer's two ways, and a clock fitted
# beside a thermometer that errs; how often the intervals hold. Arguments: first seed (1), logs of each kind (40), the
# part: tides, rods, barometers, thermometers or all (all).
set -e
. "$(dirname "$0")/common.sh"
built study_conditions
head_line "${1:-1}"
build/bench/study_conditions "${1:-1}" "${2:-40}" "${3:-all}"
