#!/usr/bin/env bash
# Builds with the bench preset and prints how the search does on clocks drawn from a prior; prior.txt holds
# one such print with its date, machine, commit and seed. Arguments: logs (600), first seed (1), "each" for a
# line a log.
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_prior > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
echo "commit $(git rev-parse --short HEAD), seed ${2:-1}"
build/bench/study_prior "${1:-600}" "${2:-1}" "${3:-}"
