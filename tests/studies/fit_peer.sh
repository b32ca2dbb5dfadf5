#!/usr/bin/env bash
# Times `goingrate fit` as a whole process on a log of 2000 periods with a jump of the drive, beside
# scipy.optimize.least_squares on the same log with the same equations. The two do not do the same:
# goingrate starts, reads the log, finds its own start, and makes intervals and tests; of scipy only
# the solver is timed, from 5 % off the truth, with the interpreter running and the log read. The
# last line times goingrate's search alone, which does the same (built with the bench preset). Takes
# seconds, and minutes for that build.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup python3-numpy python3-scipy
goingrate=build/release/goingrate
[ -x "$goingrate" ] || { echo "$goingrate is missing; build the release preset" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
log=$folder/jump.csv

# Median of the milliseconds of processor that eleven runs of a command take, after one that is not counted.
median_ms() {
  local TIMEFORMAT='%U %S'
  "$@" &> /dev/null
  for _ in {1..11}; do
    { time "$@" &> /dev/null; } 2>&1
  done | awk '{ print 1e3 * ($1 + $2) }' | sort -n | awk '{ t[NR] = $1 } END { printf "%.0f\n", t[6] }'
}

"$goingrate" simulate data/scenarios/jump.toml --set run.periods=2000 --set sensor.jitter_rms=1e-6 \
  -o "$log" 2> /dev/null
fit=("$goingrate" fit "$log" --fix T0=2 --event 150:mu)
"${fit[@]}" --model averaged1 --json "$folder/averaged1.json" -o /dev/null 2> /dev/null
"${fit[@]}" --model auto --json "$folder/auto.json" -o /dev/null 2> /dev/null

head_line
peer=$(/usr/bin/python3 tests/studies/fit_peer.py "$log" "$folder/averaged1.json")
echo "$peer"
for model in averaged1 auto; do
  took=$(median_ms "${fit[@]}" --model $model)
  chosen=$(grep -m1 '"dynamics"' "$folder/$model.json" | cut -d'"' -f4)
  awk -v model=$model -v took="$took" -v chosen="$chosen" '
    /^(lm|trf) / { ratios = ratios sprintf(", %.2f times %s", took / $2, $1) }
    END { printf "goingrate fit --model %s (dynamics %s) %.0f ms of processor a process%s\n",
          model, chosen, took, ratios }' <<< "$peer"
done
built study_fit_speed
build/bench/study_fit_speed solver "$log" | awk -v peer="$peer" '
  /^search alone/ {
    n = split(peer, line, "\n")
    for (i = 1; i <= n; ++i)
      if (split(line[i], word, " ") > 1 && (word[1] == "lm" || word[1] == "trf"))
        ratios = ratios sprintf(", %.1f times faster than %s", word[2] / $3, word[1])
    print "goingrate, " $0 ratios
  }'
