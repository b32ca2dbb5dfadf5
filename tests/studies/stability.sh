#!/usr/bin/env bash
# Times tables of all octaves beside plain numpy on the same phases, in the same run, and counts the
# rows of Stable32's tables that are reproduced if GOINGRATE_SHARED_DATA names their folder;
# stability.txt holds such a print. goingrate: one thread, in process, the whole table with noise types and
# intervals, and with the noise given; numpy: the values. Takes a few minutes once built.
set -euo pipefail
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev libbenchmark-dev libsundials-dev libgsl-dev python3-numpy
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_stability > /dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
build/bench/study_stability write "$folder/phases"
build/bench/study_stability time > "$folder/times"
/usr/bin/python3 tests/studies/stability.py "$folder/phases" "$folder/times"
build/bench/study_stability threads
build/bench/study_stability published
