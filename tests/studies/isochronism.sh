#!/usr/bin/env bash
# Prints how often the interval of a slope of the rate against the amplitude holds that of
# the simulated clock. Arguments: logs (300), first seed (1).
set -e
. "$(dirname "$0")/common.sh"
built study_isochronism
head_line "${2:-1}"
build/bench/study_isochronism "${1:-300}" "${2:-1}"
