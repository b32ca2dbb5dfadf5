#!/usr/bin/env bash
# Times tables of all octaves beside plain numpy on the same phases, in the same run, and counts the
# rows of Stable32's tables that are reproduced if GOINGRATE_SHARED_DATA names their folder;
# stability.txt holds such a print. goingrate: one thread, in process, the whole table with noise types and
# intervals, and with the noise given; numpy: the values. Takes a few minutes once built.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup python3-numpy
built study_stability
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
head_line
build/bench/study_stability write "$folder/phases"
build/bench/study_stability time > "$folder/times"
/usr/bin/python3 tests/studies/stability.py "$folder/phases" "$folder/times"
build/bench/study_stability threads
build/bench/study_stability published
