#!/usr/bin/env bash
# Prints how ring-downs fare: how often Q(A) is stated and its intervals hold the truth, and which law of
# friction is found. Arguments: logs for each law and sensor (200), first seed (1), "each" to print a line
# for each log.
set -e
. "$(dirname "$0")/common.sh"
built study_ring_down
head_line "${2:-1}"
build/bench/study_ring_down "${1:-200}" "${2:-1}" "${3:-}"
