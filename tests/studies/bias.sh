#!/usr/bin/env bash
# Prints by how much the choice of dynamics shifts the parameters of a fit. Arguments: logs of a scene
# (400), first seed (1). Takes five minutes.
set -e
. "$(dirname "$0")/common.sh"
built study_bias
head_line "${2:-1}"
build/bench/study_bias "${1:-400}" "${2:-1}"
