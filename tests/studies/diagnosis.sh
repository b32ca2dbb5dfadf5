#!/usr/bin/env bash
# Prints the confusion of causes on clocks drawn from those people have, along the whole road.
# Arguments: clocks of each kind (10), first seed (1), greatest length in days (3), "log" to leave the
# fit out (minutes instead of hours).
set -e
. "$(dirname "$0")/common.sh"
built study_diagnosis
head_line "${2:-1}"
build/bench/study_diagnosis "${1:-10}" "${2:-1}" "${3:-3}" "${4:-}"
