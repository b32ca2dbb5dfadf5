#!/usr/bin/env bash
# Prints the confusion of causes on clocks drawn from those people have: their logs go the road of every log,
# by `goingrate batch report`. Arguments: clocks of each kind (10), first seed (1), greatest length in days (3),
# "log" to leave the fit out (minutes instead of hours), which the command does not and the study does.
set -e
. "$(dirname "$0")/common.sh"
built study_diagnosis goingrate_command
head_line "${2:-1}"
each=${1:-10} seed=${2:-1} days=${3:-3}
if [ "${4:-}" = log ]; then
  exec build/bench/study_diagnosis log "$each" "$seed" "$days"
fi
work=build/bench/diagnosis-$each-$seed-$days # stays where it is interrupted, and is taken up
build/bench/study_diagnosis write "$work/logs" "$each" "$seed" "$days"
build/bench/goingrate batch report "$work/logs" --resume -o "$work/batch.jsonl"
build/bench/study_diagnosis score "$work/batch.jsonl" "$each"
rm -rf "$work"
