#!/usr/bin/env bash
# Prints how much of the cores' time a batch of short fits spends in fits, and how fast a merge is.
# Arguments: realisations (2000), threads (2). A job is reading the log's text in memory, numbering, the fit and
# its JSON; what a job without a fit takes is measured by `batch rate` of the same clocks. Takes two
# minutes and wants a quiet machine.
set -e
. "$(dirname "$0")/common.sh"
built goingrate_command
goingrate=${GOINGRATE:-build/bench/goingrate}
jobs=${1:-2000} threads=${2:-2}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
clocks=(--scenario data/scenarios/jump.toml --set run.periods=1000 --realisations "$jobs" --threads "$threads")
known="--fix T0=2 --event 150:mu --model averaged1 --noise jitter"
head_line 1
TIMEFORMAT="  %R s, processor %U s for us and %S s for the system"
for command in "fit $known --fix phi0=0.03" "fit $known" rate; do
  echo "$command, 1000 periods"
  # shellcheck disable=SC2086
  time "$goingrate" batch "${clocks[@]}" -- $command -o "$work/${command%% *}.jsonl"
done 2>&1
echo "bytes per line: $(($(wc -c < "$work/fit.jsonl") / jobs))"
for shares in 1 20; do
  for ((k = 1; k <= shares; ++k)); do
    "$goingrate" --quiet batch "${clocks[@]}" --share "$k/$shares" -- rate -o "$work/$shares-$k.jsonl"
  done
  echo "merge of $shares shares, $(cat "$work/$shares-"*.jsonl | wc -c) bytes"
  time "$goingrate" batch merge "$work/$shares-"*.jsonl -o "$work/merged.jsonl"
done 2>&1
echo "summary of $(wc -c < "$work/fit.jsonl") bytes"
time "$goingrate" batch summary "$work/fit.jsonl" -o "$work/summary" 2>&1
