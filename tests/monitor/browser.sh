#!/usr/bin/env bash
# browser.sh GOINGRATE SOURCE FOLDER: the page of a monitor in headless Chromium, for a clock whose day passes sixty
# times as fast. Its pictures are kept in FOLDER, to be looked at.
set -euo pipefail
command=$1 source=$2 folder=$3
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
[ -n "$chromium" ] || { echo "no chromium here: skipped"; exit 77; }
command -v node > /dev/null || { echo "no node here: skipped"; exit 77; }
mkdir -p "$folder"
work=$(mktemp -d)
trap 'kill $(jobs -p) 2> /dev/null || true; rm -rf "$work"' EXIT
cat > "$work/clock.toml" <<'TOML'
[clock]
nominal_period = 1.0
epsilon = 5e-4
mu = 8e-5
phi0 = 0.03
[run]
periods = 40000
[drive]
fast_rms = 0.1
[sensor]
edges = "both"
jitter_rms = 2e-5
amplitude_rms = 5e-5
TOML
"$command" --quiet simulate "$work/clock.toml" --seed 5 -o "$work/whole.csv"
# It stands still for a third of a period, and is not heard for thirty beats.
awk -F, -v OFS=, '!/^[0-9]/ { print; next } ++n > 2000 && n <= 2400 || n > 4000 && n <= 4060 { next }
  n > 2400 { $1 = sprintf("%.8f", $1 + 0.37) } 1' "$work/whole.csv" > "$work/clock.csv"
mkfifo "$work/pipe"
"$command" monitor "$work/pipe" --archive "$work/archive" --listen 127.0.0.1:0 --name '<i>Hall</i> clock' 2> "$work/said" &
{
  head -20000 "$work/clock.csv"
  tail -n +20001 "$work/clock.csv" | while IFS= read -r line; do
    printf '%s\n' "$line"
    sleep 0.008
  done
} > "$work/pipe" &
until grep -q 'port' "$work/said"; do sleep 0.1; done
port=$(sed -n 's/.*port //p' "$work/said" | head -1)
node "$source/tests/monitor/browser.mjs" "$chromium" "http://127.0.0.1:$port/" "$folder"
