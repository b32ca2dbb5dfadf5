#!/usr/bin/env bash
# Prints how a ring-down tells the share of gravity in the restoring torque: for torsion, a spring beside gravity,
# gravity alone and cheeks, at several first swings, how often the 68 % and 95 % intervals of `gravity_share` and of
# `epsilon` hold.
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
# The widest first swings: 103 and 139 degrees under gravity, 137 of torsion.
for clock in "1 0.1" "1 0.3" "1 1.2" "1 1.5666" "1 1.873" "0.9 0.1" "0.9 0.3" "0.9 1.2" "0.9 1.6" "0.5 0.1" "0.5 0.3" \
  "0.5 1.2" "0.5 2.0" "0 0.1" "0 0.3" "0 1.2" "0 2.4" "-0.5 0.1" "-0.5 0.3" "-0.5 1.2" "-0.5 1.86"; do
  read -r share swing <<< "$clock"
  "$goingrate" batch --scenario "$here/ring-down.toml" --set clock.gravity_share=$share \
    --set start.amplitude=$swing --realisations "${2:-100}" --seed "$seed" -o "$here/all.jsonl" --quiet \
    -- fit --free gravity_share
  "$goingrate" batch summary "$here/all.jsonl" | grep -E '^(gravity_share|epsilon) ' | sed "s/^/$share $swing; /"
  rm "$here/all.jsonl"
  seed=$((seed + 1000)) # no log of one row has the noise of another's
done
