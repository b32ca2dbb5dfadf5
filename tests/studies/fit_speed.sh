#!/usr/bin/env bash
# Builds with the bench preset and prints what a fit costs and how far it is off, for the dynamics and
# for thinned logs; fit_speed.txt holds one such print with its date and machine. Takes two minutes.
set -e
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev
cmake --preset bench > /dev/null
cmake --build --preset bench -j2 --target study_fit_speed > /dev/null
date -u +%Y-%m-%d
grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
build/bench/study_fit_speed year
