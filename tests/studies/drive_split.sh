#!/usr/bin/env bash
# Builds with the bench preset and prints how often the intervals of fast and slow drive hold the
# truth, with the clock known and with fitted clocks; drive_split.txt holds one such print with its date,
# machine, commit and seed. Arguments: logs with the clock known (208), with fitted clocks (40), first seed
# of these (1). Takes a quarter of an hour.
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_drive_split > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
echo "commit $(git rev-parse --short HEAD), seed ${3:-1}"
build/bench/study_drive_split "${1:-208}" "${2:-40}" "${3:-1}"
