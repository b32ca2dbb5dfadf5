#!/usr/bin/env bash
# Prints which changes are found, dated and named in logs of random clocks of which nothing is told.
# Arguments: logs a row (40), first seed (1).
set -e
. "$(dirname "$0")/common.sh"
built study_kinds
head_line "${2:-1}"
build/bench/study_kinds "${1:-40}" "${2:-1}"
