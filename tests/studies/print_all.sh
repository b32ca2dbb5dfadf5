#!/usr/bin/env bash
# Runs every study and keeps its print beside it, so that all belong to one commit. Arguments: a number from which
# the seeds are made, which nobody has used before; clocks of each kind (10) and days (3) of the diagnosis.
# Takes some hours; the timings need a quiet machine.
set -e
cd "$(dirname "$0")"
base=${1:?a number from 1 on that makes the seeds}000000
print() { # NAME ARGUMENT...
  local name=$1
  shift
  echo "$name"
  ./"$name.sh" "$@" > "$name.txt.part"
  mv "$name.txt.part" "$name.txt"
}
print numbering 5000 "$base"
print prior 600 "$base"
print kinds 40 "$base"
print moment 200 "$base"
print impulses "$base" 300
print rests
print gravity_share "$base" 100
print conditions "$base" 40
print bias 400 "$base"
print coverage 300 "$base"
print drive_split 208 40 "$base"
print noisy_drive 60 "$base"
print weather 100 "$base"
print isochronism 300 "$base"
print ring_down 10 "$base"
print monitor 4 "$base"
print watch_cost
print ten_years
print report_speed 7 "$base"
print speed 10000000
for name in solvers fit_speed fit_peer reading stability python web; do
  print "$name"
done
print diagnosis "${2:-10}" "$base" "${3:-3}"
