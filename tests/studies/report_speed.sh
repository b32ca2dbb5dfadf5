#!/usr/bin/env bash
# Prints how long a report on logs of growing length takes, in seconds of processor time and in units of a simulation
# of a million periods by rk4 with steps of 0.03: upward crossings alone, and both directions with amplitudes, as in a
# monitor's archive; the drive is noisy and wanders. Arguments: the longest log in millions of events (7), seed (1).
set -e
. "$(dirname "$0")/common.sh"
built_command
head_line "${2:-1}"
cd "$here"
cat > clock.toml <<'TOML'
[clock]
nominal_period = 2.0
epsilon = 2.5e-4
mu = 4e-5
phi0 = 0.03
[run]
periods = 1000000
method = "map"
[drive]
fast_rms = 0.2
slow_rms = 0.02
slow_time = 3600.0
[sensor]
jitter_rms = 5e-5
TOML
seconds() { # of processors, that a command takes
  local TIMEFORMAT='%U %S'
  { time "$@" > printed 2> errors; } 2>&1 | awk '{ print $1 + $2 }'
}
unit=$(seconds "$goingrate" --quiet simulate clock.toml --set run.method=rk4 --set run.dt=0.03 -o rk4.csv)
printf 'a million periods by rk4: %.1f s\n\n   events   upward: s   of rk4   both, amplitudes: s   of rk4\n' "$unit"
for events in 100000 300000 1000000 3000000 7000000; do
  [ "$events" -le $((${1:-7} * 1000000)) ] || break
  "$goingrate" --quiet simulate clock.toml --set run.periods=$events --seed "${2:-1}" -o up.csv
  "$goingrate" --quiet simulate clock.toml --set run.periods=$((events / 2)) --set sensor.edges=both \
    --set sensor.amplitude_rms=1e-4 --seed "${2:-1}" -o both.csv
  up=$(seconds "$goingrate" --quiet report up.csv -o page.html)
  both=$(seconds "$goingrate" --quiet report both.csv -o page.html)
  awk -v n=$events -v up="$up" -v both="$both" -v unit="$unit" \
    'BEGIN { printf "%9d %11.1f %8.1f %21.1f %8.1f\n", n, up, up / unit, both, both / unit }'
done
