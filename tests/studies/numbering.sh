#!/usr/bin/env bash
# Builds with the bench preset and prints how well 5000 faulty logs are numbered; numbering.txt holds
# one such print with its date and machine. Takes a minute once built.
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_numbering > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
echo "commit $(git rev-parse --short HEAD)"
build/bench/study_numbering
