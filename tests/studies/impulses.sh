#!/usr/bin/env bash
# Prints how often the pushes of escapements that rest are found, how often their number of swings is right, and
# how often the friction that they amount to holds, on clocks drawn from a prior; healthy clocks and wheels that
# are not round beside them. Arguments: first seed (1), logs of each kind (100).
set -e
. "$(dirname "$0")/common.sh"
built study_impulses
head_line "${1:-1}"
build/bench/study_impulses "${1:-1}" "${2:-100}"
