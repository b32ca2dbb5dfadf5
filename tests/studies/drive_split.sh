#!/usr/bin/env bash
# Builds with the bench preset and prints how often the intervals of fast and slow drive hold the
# truth; drive_split.txt holds one such print with its date and machine. Argument:
# logs in all, 208 if not given, which take some three minutes.
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_drive_split > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
build/bench/study_drive_split "${1:-208}"
