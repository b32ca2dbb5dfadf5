#!/usr/bin/env bash
# Prints how the search does on clocks drawn from a prior: with a jump, and with a rough drive and amplitudes.
# Arguments: logs (600) of the first, and a quarter as many of the second; first seed (1), "each" for a line
# a log.
set -e
. "$(dirname "$0")/common.sh"
built study_prior
logs=${1:-600}
head_line "${2:-1}"
echo "a jump of mu, phi0 or epsilon"
build/bench/study_prior "$logs" "${2:-1}" jump "${3:-}"
echo "a rough drive, fast and slow, and amplitudes"
build/bench/study_prior $(((logs + 3) / 4)) "${2:-1}" rough "${3:-}"
