#!/usr/bin/env bash
# Prints what a fit costs and how far it is off, for the dynamics and for thinned logs. Takes two
# minutes.
set -e
. "$(dirname "$0")/common.sh"
built study_fit_speed
head_line
build/bench/study_fit_speed year
