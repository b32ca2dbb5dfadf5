#!/usr/bin/env bash
# Prints how often the intervals of fast and slow drive hold the truth, with the clock known and with
# fitted clocks. Arguments: logs with the clock known (208), with fitted clocks (40), first seed (1).
# Takes a quarter of an hour.
set -e
. "$(dirname "$0")/common.sh"
built study_drive_split
head_line "${3:-1}"
build/bench/study_drive_split "${1:-208}" "${2:-40}" "${3:-1}"
