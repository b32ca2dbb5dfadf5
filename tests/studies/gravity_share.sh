#!/usr/bin/env bash
# Prints how a ring-down tells the share of gravity in the restoring torque: for torsion, a spring beside gravity,
# gravity alone and cheeks, at several first swings, how often the 68 % and 95 % intervals of `gravity_share` and of
# `epsilon` hold; and the same, with T0, where the log has times alone.
# Arguments: first seed (1), logs of each kind (100).
set -e
. "$(dirname "$0")/common.sh"
built_command
cat > "$here/ring-down.toml" << 'END'
[clock]
nominal_period = 1.7
epsilon = 1e-3
escapement = "none"
[start]
amplitude = 0.3
[run]
periods = 400
[sensor]
jitter_rms = 5e-5
amplitude_rms = 2e-4
END
head_line "${1:-1}"
echo "share first swing; of each: truth, determined, 68 %, 95 %, mean and sd of the pull, sigma, over scatter"
seed=${1:-1}
logs=${2:-100}

# One row for each parameter of NAMES (a|b|c): row SCENARIO NAMES SHARE SWING
row() {
  "$goingrate" batch --scenario "$here/$1" --set clock.gravity_share="$3" --set start.amplitude="$4" \
    --realisations "$logs" --seed "$seed" -o "$here/all.jsonl" --quiet -- fit --free gravity_share
  "$goingrate" batch summary "$here/all.jsonl" | grep -E "^($2) " | sed "s/^/$3 $4; /"
  rm "$here/all.jsonl"
  seed=$((seed + 1000)) # no log of one row has the noise of another's
}

# The widest first swings: 103 and 139 degrees under gravity, 137 of torsion.
for clock in "1 0.1" "1 0.3" "1 1.2" "1 1.5666" "1 1.873" "0.9 0.1" "0.9 0.3" "0.9 1.2" "0.9 1.6" "0.5 0.1" "0.5 0.3" \
  "0.5 1.2" "0.5 2.0" "0 0.1" "0 0.3" "0 1.2" "0 2.4" "-0.5 0.1" "-0.5 0.3" "-0.5 1.2" "-0.5 1.86"; do
  read -r share swing <<< "$clock"
  row ring-down.toml 'gravity_share|epsilon' "$share" "$swing"
done
echo "times alone"
sed '/^amplitude_rms/d' "$here/ring-down.toml" > "$here/times.toml"
for clock in "1 0.15" "1 0.6" "1 1.0" "0.5 0.6" "0.5 1.2" "-0.5 0.8"; do
  read -r share swing <<< "$clock"
  row times.toml 'T0|gravity_share|epsilon' "$share" "$swing"
done
