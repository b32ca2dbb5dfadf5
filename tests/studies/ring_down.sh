#!/usr/bin/env bash
# Prints how ring-downs fare: how often Q(A) is stated and its intervals hold the truth, and which law of
# friction is found. Arguments: logs a law and a sensor (200), first seed (1), "each" for a line a log.
set -e
. "$(dirname "$0")/common.sh"
built study_ring_down
head_line "${2:-1}"
build/bench/study_ring_down "${1:-200}" "${2:-1}" "${3:-}"
