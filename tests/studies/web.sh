#!/usr/bin/env bash
# The page for a browser against the command: on logs of every format its beats, rates and deviations are the command's
# to the last printed digit, its fits within 0.02 σ. Prints how long a report takes in each, on one processor. Takes
# half an hour with the libraries of the page still to be compiled, and wants a quiet machine for the times.
set -e
. "$(dirname "$0")/common.sh"
apps/web/build.sh >&2
cmake --preset release > /dev/null
cmake --build --preset release -j2 --target goingrate_command > /dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
head_line
ls -l build/web/goingrate.html | awk '{printf "the page: %.2f MB\n", $5 / 1e6}'
node tests/web/same_numbers.mjs "$PWD/build/web/goingrate.html" "$PWD/build/release/goingrate" "$PWD" "$work"
