#!/usr/bin/env bash
# Builds with the bench preset and prints the confusion of causes on clocks drawn from those people have,
# along the whole road; diagnosis.txt holds one such print with its date, machine, commit and seed.
# Arguments: clocks of each kind (10), first seed (1), greatest length in days (3), "log" to leave the
# fit out (minutes instead of hours).
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_diagnosis > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
echo "commit $(git rev-parse --short HEAD), seed ${2:-1}"
build/bench/study_diagnosis "${1:-10}" "${2:-1}" "${3:-3}" "${4:-}"
