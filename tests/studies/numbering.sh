#!/usr/bin/env bash
# Prints how many beats of random faulty logs are given the right cycle number. Arguments: number of
# logs (default 5000), first seed (default 70001). Takes about a minute, not counting the build.
set -e
. "$(dirname "$0")/common.sh"
built study_numbering
head_line "${2:-70001}"
build/bench/study_numbering "${1:-5000}" "${2:-70001}"
