#!/usr/bin/env bash
# Prints bias and coverage of fits of clocks with a noisy drive. Arguments: logs per scene (300), first
# seed (1), words that a scene's name must contain. Takes some ten seconds per log on one core.
set -e
. "$(dirname "$0")/common.sh"
built study_noisy_drive
head_line "${2:-1}"
build/bench/study_noisy_drive "${1:-300}" "${2:-1}" "${3:-}"
