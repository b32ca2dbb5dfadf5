#!/usr/bin/env bash
# Prints how the search does on clocks drawn from a prior. Arguments: logs (600), first seed (1), jump
# or rough, "each" for a line a log.
set -e
. "$(dirname "$0")/common.sh"
built study_prior
head_line "${2:-1}"
build/bench/study_prior "${1:-600}" "${2:-1}" "${3:-jump}" "${4:-}"
