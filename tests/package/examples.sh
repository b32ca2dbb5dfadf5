#!/usr/bin/env bash
# The example programs do what they say. Arguments: the folder they are in, the project's.
set -euo pipefail
examples=$1 source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
expect() { grep -qE "$1" "$scratch/out" || { echo "expected $1, found:"; cat "$scratch/out"; exit 1; }; }

"$examples/report_on_a_log" "$source/data/logs/jump.csv" "$scratch/page.html" > "$scratch/out"
expect '^  rate over the whole log'
expect '^epsilon = '
tail -c 8 "$scratch/page.html" | grep -q '</html>'
code=0
"$examples/report_on_a_log" "$scratch/none.csv" "$scratch/none.html" 2> "$scratch/out" || code=$?
[ "$code" -eq 3 ] && expect 'none.csv'

"$examples/coverage_of_a_fit" "$source/data/scenarios/jump.toml" 20 > "$scratch/out"
# In all but one of a thousand runs, 8 to 19 of 20 logs lie in the 68 % interval, and 15 or more in the
# other.
expect 'in its 68 % interval in ([89]|1[0-9]) of 20 logs, in its 95 % interval in (1[5-9]|20)$'

"$examples/friction_of_my_own" > "$scratch/out"
expect 'linear friction: +amplitude 0.0[0-9]+ rad, rate [+-]'
# The two laws have one loss at one speed: the amplitudes are near each other, and not the same.
awk '{ for (i = 1; i < NF; ++i) if ($i == "amplitude") a[NR] = $(i + 1) }
     END { r = a[1] / a[2]; exit !(r != 1 && r > 0.8 && r < 1.25) }' "$scratch/out"
