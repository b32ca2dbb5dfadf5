#!/usr/bin/env bash
# Prints how often the fit's intervals hold the truth, by `goingrate batch`, and behind each scene the
# Cramer-Rao bounds of the full simulator (absolute), to hold the column sigma against. Arguments: logs of a
# scene (300; a third as many of the scene of a million periods), first seed (1000). Takes a quarter of an hour.
set -e
. "$(dirname "$0")/common.sh"
built study_coverage goingrate_command
logs=${1:-300} seed=${2:-1000}
head_line "$seed"
scenes=tests/studies/coverage
work=build/bench/coverage-$logs-$seed # stays where it is interrupted, and is taken up
mkdir -p "$work"
number=0
scene() { # "what" LOGS SCENARIO ["KEY=VALUE ..."] -- WORDS OF THE FIT
  local what=$1 count=$2 file=$scenes/$3.toml over=() words=() word fixed=()
  shift 3
  while [ "$1" != -- ]; do over+=(--set "$1"); shift; done
  shift
  words=("$@")
  for word in "$@"; do [[ $word == T0=* ]] && fixed=(T0); done
  printf '\n%s\n' "$what"
  build/bench/goingrate batch --scenario "$file" "${over[@]}" --realisations "$count" \
    --seed $((seed + 1000 * number)) -- fit "${words[@]}" --resume -o "$work/$number.jsonl" 2> "$work/notes"
  grep ' jobs in ' "$work/notes" || true
  build/bench/goingrate batch summary "$work/$number.jsonl"
  number=$((number + 1))
  build/bench/study_coverage "$file" "${over[@]}" "${fixed[@]}"
}
scene "jump, jitter 1e-6 s, T0 known" "$logs" jump -- --event 150:mu --fix T0=2
scene "jump, jitter 1e-6 s, T0 free" "$logs" jump -- --event 150:mu
scene "jump, jitter 1e-4 s, T0 known" "$logs" jump sensor.jitter_rms=1e-4 -- --event 150:mu --fix T0=2
scene "jump, jitter 1e-4 s, T0 free" "$logs" jump sensor.jitter_rms=1e-4 -- --event 150:mu
scene "ring-down" "$logs" ring-down -- --event none
scene "start-up" "$logs" start-up -- --event none
scene "jump, drive noise 3 %" "$logs" jump run.periods=4000 sensor.jitter_rms=1e-5 drive.fast_rms=0.03 \
  -- --event 150:mu --fix T0=2
scene "jump, amplitude column" "$logs" jump sensor.jitter_rms=1e-5 sensor.amplitude_rms=1e-5 -- --event 150:mu
many=$(((logs + 2) / 3))
scene "stationary at B, drive noise 30 %, T0 known, amplitude seen to 10 %" "$many" noisy \
  -- --event none --fix T0=2 --prior lambda0=0.0552840336990741+-0.00552840336990741
scene "stationary at B, drive noise 30 %, T0 known" "$many" noisy -- --event none --fix T0=2
scene "jump, fast drive 3 %, slow drive 2 %" "$logs" jump run.periods=20000 drive.fast_rms=0.03 \
  drive.slow_rms=0.02 drive.slow_time=2000 -- --event 150:mu --fix T0=2 --noise slow
scene "single impulse, jump" "$logs" impulse -- --event 150:impulse --fix T0=2 --escapement single-impulse
rm -rf "$work"
