#!/usr/bin/env bash
# Prints how the fit does on clocks drawn from a prior that change in the middle of a swing, integrated by a
# program that knows of no beats: the change found, told as the nearest crossing's swings, and, for comparison,
# taken to be at that crossing. Arguments: logs (200), first seed (1), "each" for a line a log.
set -e
. "$(dirname "$0")/common.sh"
built study_moment
head_line "${2:-1}"
build/bench/study_moment "${1:-200}" "${2:-1}" ${3:+each}
