#!/usr/bin/env bash
# Prints which beats are found in recordings that the study makes itself: 40 to 0 dB is the power at
# the peak of the loudest click over that of the noise. "lost" are recordings whose period is not
# found; bias is that of the beats' beginning, "t-t" by how much it differs between tick and tock.
# Arguments: recordings per scene (10), first seed (1).
set -e
. "$(dirname "$0")/common.sh"
built study_sound
head_line "${2:-1}"
build/bench/study_sound "${1:-10}" "${2:-1}"
