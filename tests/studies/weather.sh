#!/usr/bin/env bash
# Prints how often the interval of a temperature coefficient holds the truth, with the weather in a
# file of its own. Arguments: logs per thermometer (300), first seed (1).
set -e
. "$(dirname "$0")/common.sh"
built study_weather
head_line "${2:-1}"
build/bench/study_weather "${1:-300}" "${2:-1}"
