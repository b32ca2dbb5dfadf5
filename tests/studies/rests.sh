#!/usr/bin/env bash
# Prints what an impulse once in N swings buys at equal power: mean amplitude, mean rate, the escapement's part of
# the rate (that of an impulse off the vertical less that of one at it), what 1 % more drive does to the rate, and
# the saw-tooth; and draws data/guide/pictures/rests.svg. All clocks: T0 2 s, Q 5000, 0.04 rad, 180,000 periods.
set -e
. "$(dirname "$0")/common.sh"
goingrate_setup gnuplot-nox
built_command
cat > "$here/clock.toml" << 'END'
[clock]
epsilon = 1e-4
escapement = "single-impulse"
[run]
periods = 180000
method = "map"
END

# Mean rate in s/day and rms amplitude of a clock of N, energy per swing and angle of the impulse.
mean_of() {
  "$goingrate" simulate "$here/clock.toml" --quiet --set clock.every="$1" \
    --set clock.impulse="$(awk "BEGIN { print $1 * $2 }")" --set clock.angle="$3" \
    -o /dev/null --truth "$here/truth.csv"
  awk -F, -v n="$1" 'NR > 1 { s += $4 * $4; t = $2; k = $1 }
    NR > 1 && $1 <= n { late[$1 % n] = $2 }
    END { period = t / k; for (m in late) { d = late[m] - period * (m == 0 ? n : m); if (d > most) most = d; if (d < least) least = d }
      printf "%.9f %.9f %.3f\n", (2 * k / t - 1) * 86400, sqrt(s / k), 1e6 * (most - least) }' "$here/truth.csv"
}

head_line
echo "N   amplitude   rate       of the escapement  by 1 % more drive  saw-tooth"
echo "    mrad        s/day      s/day              ms/day             us"
for n in 1 2 5 15 30 60 120; do
  read -r rate swing tooth < <(mean_of "$n" 1e-6 0.01)
  read -r plain _ < <(mean_of "$n" 1e-6 0)
  read -r more _ < <(mean_of "$n" 1.01e-6 0.01)
  awk -v n="$n" -v r="$rate" -v a="$swing" -v p="$plain" -v m="$more" -v t="$tooth" \
    'BEGIN { printf "%-3d %.5f    %.5f   %.6f          %.3f            %.2f\n", n, 1e3 * a, r, r - p, 1e3 * (m - r), t }'
done | tee "$here/table"
gnuplot << END
set terminal svg size 720,380 font "sans,13" background "white"
set output "data/guide/pictures/rests.svg"
set logscale x
set xrange [0.9:135]
set xtics (1, 2, 5, 15, 30, 60, 120)
set xlabel "swings from one impulse to the next, at equal power"
set ylabel "escapement error, s/day"
set yrange [-3:0.2]
set y2label "saw-tooth of the times, ms" textcolor rgb "#b04000"
set y2range [0:*]
set y2tics textcolor rgb "#b04000"
set ytics nomirror
set key left center
plot "$here/table" using 1:4 with linespoints pt 7 lc rgb "#1060a0" title "escapement error (left)", \
     "$here/table" using 1:(1e-3*\$6) axes x1y2 with linespoints pt 5 lc rgb "#b04000" title "saw-tooth (right)"
END
