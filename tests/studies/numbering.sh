#!/usr/bin/env bash
# Prints how well faulty logs are numbered. Arguments: logs (5000), first seed (70001). Takes a minute
# once built.
set -e
. "$(dirname "$0")/common.sh"
built study_numbering
head_line "${2:-70001}"
build/bench/study_numbering "${1:-5000}" "${2:-70001}"
