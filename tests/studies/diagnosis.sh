#!/usr/bin/env bash
# Builds with the bench preset and prints the confusion of causes on simulated weeks; diagnosis.txt
# holds one such print with its date and machine. Takes some minutes.
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_diagnosis > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
build/bench/study_diagnosis "${1:-28}"
