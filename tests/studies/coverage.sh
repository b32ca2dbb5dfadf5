#!/usr/bin/env bash
# Prints how often the fit's intervals hold the truth. Arguments: logs of a scene (300), first seed
# (1000). Takes a quarter of an hour.
set -e
. "$(dirname "$0")/common.sh"
built study_coverage
head_line "${2:-1000}"
build/bench/study_coverage "${1:-300}" "${2:-1000}"
