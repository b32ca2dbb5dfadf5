#!/usr/bin/env bash
# An archive on paper: 10,000 clocks over ten years, a log a month, a beat every two seconds, from measured shares
# of it. Prints bytes, core-hours, and at how many cores the merge takes as long as the jobs. Arguments: months
# that are measured (4), seed (1). The merge is measured on shares of short logs, whose lines are as long.
# Takes two minutes and wants a quiet machine.
set -e
. "$(dirname "$0")/common.sh"
built goingrate_command
goingrate=$PWD/build/bench/goingrate
months=${1:-4} seed=${2:-1}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
head_line "$seed"
cd "$work"
periods=1314900 # of 2 s: 10 years are 120 such months
"$goingrate" --quiet simulate "$OLDPWD/data/scenarios/noisy-drive.toml" --set run.periods=$periods \
  --set run.method=map --set drive.fast_rms=0.03 --set sensor.jitter_rms=1e-5 --seed "$seed" \
  --realisations "$months" -o month.csv
mkdir logs && mv month-*.csv logs
first=$(ls -d logs/* | head -n 1)
log_bytes=$(wc -c < "$first") packed_bytes=$(gzip -c "$first" | wc -c)
# What standard error says of the jobs: "... , SECONDS s each; ..."
seconds_each() { grep -oE '[0-9.e-]+ s each' "$1" | awk '{sum += $1} END {print sum / NR}'; }
for command in rate fit; do
  for k in 1 2; do
    "$goingrate" batch $command logs --threads 1 --share $k/2 -o $command-$k.jsonl 2> $command-$k.notes
  done
  cat $command-?.notes > $command.notes
  "$goingrate" batch merge $command-?.jsonl -o $command.jsonl
done
lines=20000
for ((k = 1; k <= 20; ++k)); do
  "$goingrate" --quiet batch --scenario "$OLDPWD/data/scenarios/jump.toml" --set run.periods=30 \
    --realisations $lines --share $k/20 -- rate -o share-$k.jsonl
done
merged_bytes=$(cat share-*.jsonl | wc -c)
begin=$(date +%s.%N)
"$goingrate" batch merge share-*.jsonl -o merged.jsonl
merge_s=$(awk -v from="$begin" -v to="$(date +%s.%N)" 'BEGIN {print to - from}')
jobs=$((10000 * 120))
awk -v jobs=$jobs -v periods=$periods -v log_bytes="$log_bytes" -v packed="$packed_bytes" -v merged="$merged_bytes" \
  -v merge_s="$merge_s" -v lines=$lines 'BEGIN {
  printf "%d logs of %d beats, %.2g beats in all\n", jobs, periods, jobs * periods
  printf "logs: %.1f MB each, %.1f packed; %.0f TB and %.0f\n", log_bytes / 1e6, packed / 1e6, jobs * log_bytes / 1e12, jobs * packed / 1e12
  printf "merge of 20 shares, %d lines, %.0f MB: %.2f s, %.1f us per line, %.0f MB/s\n", lines, merged / 1e6, merge_s, 1e6 * merge_s / lines, merged / merge_s / 1e6 }'
for command in rate fit; do
  awk -v command=$command -v jobs=$jobs -v each="$(seconds_each $command.notes)" -v bytes="$(wc -c < $command.jsonl)" \
    -v months="$months" -v log_bytes="$log_bytes" -v merge_s="$merge_s" -v merged="$merged_bytes" 'BEGIN {
    line = bytes / months; merge = jobs * line * merge_s / merged
    printf "batch %s: %.2f s a log, %.0f core-hours; %.1f kB a line, %.1f GB in all\n", command, each, jobs * each / 3600, line / 1e3, jobs * line / 1e9
    printf "  merge %.0f s; it takes as long as the jobs on %.0f cores, which read %.0f GB/s by then\n", merge, jobs * each / merge, log_bytes / each * jobs * each / merge / 1e9
    printf "  a file system that gives 1 GB/s feeds %.0f cores\n", 1e9 * each / log_bytes }'
done
