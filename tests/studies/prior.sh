#!/usr/bin/env bash
# Prints how the search does on clocks drawn from a prior: with a jump, and with a rough drive and amplitudes.
# Each log is fitted by `goingrate batch` three ways: from what people know; started at the truth, which is in a file
# of parameters beside the log; and started there with one parameter after the other held. Arguments: logs (600) of
# the first kind, and a quarter as many of the second; first seed (1), "each" for a line per log.
set -e
. "$(dirname "$0")/common.sh"
built study_prior goingrate_command
fit_all() { # LOGS SEED KIND [each]
  local work=build/bench/prior-$1-$2-$3 way # stays where it is interrupted, and is taken up
  build/bench/study_prior write "$work" "$1" "$2" "$3"
  for way in found told held-0 held-1 held-2 held-3 held-4; do
    build/bench/goingrate batch fit "$work/logs/*.csv" --from "{.}.$way" --resume -o "$work/$way.jsonl"
  done 2>&1 | grep ' jobs in '
  build/bench/study_prior score "$work" "$@"
  rm -rf "$work"
}
logs=${1:-600} seed=${2:-1}
head_line "$seed"
echo "a jump of mu, phi0 or epsilon"
fit_all "$logs" "$seed" jump "${3:-}"
echo "a rough drive, fast and slow, and amplitudes"
fit_all $(((logs + 3) / 4)) "$seed" rough "${3:-}"
