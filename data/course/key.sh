#!/usr/bin/env bash
# The teacher's key for one student: a log for each worksheet and the answers that go with it.
#   data/course/key.sh [SEED [FOLDER]]      FOLDER is course-out/key-SEED if not given
# Needs goingrate on the PATH. The logs are FOLDER/1-first-log.csv and so on, the answers FOLDER/key.md.
set -euo pipefail
export LC_ALL=C
seed=${1:-1}
folder=${2:-course-out/key-$seed}
course=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$folder"
key=$folder/key.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

say() { echo "$*" >> "$work/key.md"; }
run() { goingrate --quiet "$@"; }
# calc FORMAT EXPRESSION
calc() { awk "BEGIN { pi = atan2(0, -1); printf \"$1\", $2 }"; }
# The first KEY of a scenario; the last with a third argument (an event's).
truth() {
  awk -F '[ =#]+' -v key="$2" -v last="${3:-}" \
    '$1 == key && (last || !seen) {value = $2; seen = 1} END {print value}' "$course/$1.toml"
}
json() { sed -nE "s/^  \"$2\": ([-+0-9.e]+),?\$/\\1/p" "$1" | sed -n 1p; }
fitted() { awk -F, -v name="$2" -v column="$3" '$1 == name {print $column}' "$1"; }
# plus_minus VALUE SIGMA -> both rounded to two digits of sigma, small ones with a power of ten
plus_minus() {
  awk -v value="$1" -v sigma="$2" 'function order(x) { x = log(x < 0 ? -x : x) / log(10); return int(x) - (x < int(x)) }
    BEGIN {
      power = value == 0 ? order(sigma) : order(value)
      power = power < -2 ? power : 0
      digits = power + 1 - order(sigma)
      number = "%." (digits < 0 ? 0 : digits) "f"
      text = sprintf(number " ± " number, value / 10 ^ power, sigma / 10 ^ power)
      print power ? "(" text ")e" power : text
    }'
}
# off NAME TRUTH CSV: how far from the truth, in units of the 68 % interval on the truth's side
off() {
  awk -F, -v name="$1" -v truth="$2" '$1 == name && $3 != "" {
    printf "%+.1f", ($2 - truth) / (truth > $2 ? $5 - $2 : $2 - $4)
  }' "$3"
}
# compare NAME TRUTH CSV: one line of a table
compare() {
  row "$1" "$2" "$(fitted "$3" "$1" 2)" "$(fitted "$3" "$1" 3)" "$(off "$1" "$2" "$3")"
}
row() { # NAME TRUTH VALUE SIGMA [OFF]
  if [ -z "$3" ] || [ -z "$4" ]; then
    say "| $1 | $2 | undetermined | – |"
  else
    say "| $1 | $2 | $(plus_minus "$3" "$4") | ${5:-$(calc '%+.1f' "($3 - $2) / $4")} |"
  fi
}
table() {
  say
  say "| parameter | truth | goingrate finds | off by (sigma) |"
  say "|---|---|---|---|"
}
# log NAME -> the student's log
log() {
  run simulate "$course/$1.toml" --seed "$seed" -o "$folder/$1.csv"
  say
  say "## ${1%%-*}. $(sed -n '1s/^# [0-9]*\. //p' "$course/$1.md")"
  say
  say "Log: \`$1.csv\`, made by \`goingrate simulate data/course/$1.toml --seed $seed\`."
}

first_log() {
  local name=1-first-log log json fit s n T naive beats missed spurious rate sigma slope true_period
  log "$name"
  log=$folder/$name.csv json=$work/1.json fit=$work/1.csv
  run rate "$log" -o "$work/1-rates.csv" --json "$json"
  run fit "$log" --csv "$fit" -o "$work/1.txt"
  n=$(json "$json" periods) missed=$(json "$json" missed) spurious=$(json "$json" spurious)
  beats=$(json "$json" crossings) rate=$(json "$json" rate_s_per_day) sigma=$(truth $name jitter_rms)
  T=$(truth $name nominal_period)
  naive=$(awk '/^[0-9]/ {if (!n++) first = $1; last = $1} END {printf "%.9f", (last - first) / (n - 1)}' "$log")
  s=$(awk -f "$course/periods.awk" "$work/1-rates.csv" | sed -nE 's/.*scatter ([0-9.]+) ms/\1/p')
  slope=$(sed -nE 's/^ *fitted mean period +([0-9.]+) ± ([0-9.]+) s.*/\1 \2/p' "$work/1.txt")
  true_period=$(run map --phi0 "$(truth $name phi0)" --solve epsilon="$(truth $name epsilon)" mu="$(truth $name mu)" \
    | awk -v T="$T" 'END {printf "%.9f", T / (1 + $5)}')
  table
  compare jitter_rms "$sigma" "$fit"
  row "mean period, s" "$true_period" "${slope% *}" "${slope#* }"
  say
  say "- Q1. Mean period $(calc %.6f "$naive") s, $(calc %+.0f "86400 * ($T / $naive - 1)") s a day."
  say "- Q2. One beat in $n: $(calc %.0f "86400 / $n") s a day. $beats beats, $missed missed, $spurious spurious:" \
    "$n periods were counted as $(calc %d "$n - $missed + $spurious"), which makes" \
    "$(calc %.0f "86400 * ($missed - $spurious) / $n") s a day. Numbered rightly the clock gains" \
    "$(calc %.2f "$rate") s a day."
  say "- Q3. $s ms over the root of $n: $(calc %.0f "1e3 * $s / sqrt($n)") µs, or" \
    "$(calc %.1f "86.4 * $s / sqrt($n) / $T") s a day."
  say "- Q4. p_n = T + j_n − j_(n−1): variance 2σ² (scatter $(calc %.2f "1e3 * sqrt(2) * $sigma") ms), covariance of" \
    "neighbours −σ², correlation −1/2. A late stamp makes one period long and the next one short; the clock is innocent."
  say "- Q5. The sum is t_N − t_0: all stamps between drop out, and mean and ends are the same number. Its error is" \
    "√2 σ/N = $(calc %.2f "1e6 * sqrt(2) * $sigma / $n") µs, $(calc %.3f "86400 * sqrt(2) * $sigma / $n / $T") s a day. Two stamps" \
    "were used."
  say "- Q6. √12 σ/N^(3/2) = $(calc %.1f "1e9 * sqrt(12) * $sigma / $n ^ 1.5") ns, that is" \
    "$(calc %.4f "86400 * sqrt(12) * $sigma / $n ^ 1.5 / $T") s a day. Better than the ends by √(N/6):" \
    "$(calc %.0f "sqrt($n / 6)") after an hour, $(calc %.0f "sqrt(43200 / 6)") after a day."
  say "- Q7. Change something: let it ring down, change the weight, measure the amplitude. (A known T0 helps too.)"
  say "- Q8. −1 (√3 σ/τ: $(calc %.2g "sqrt(3) * $sigma / 2") at 2 s). With independent periods −1/2."
  say "- Q9. √2 σ/t = 1/86400: $(calc %.0f "86400 * sqrt(2) * $sigma") s. A minute! But a minute says nothing of the next hour."
  say "- Q10. That of the ends. For a clock whose own rate wanders: its stamps do not scatter independently about a line."
}

ring_down() {
  local name=2-ring-down log json fit eps T A tau N lost A0 sigma
  log "$name"
  log=$folder/$name.csv json=$work/2.json fit=$work/2.csv
  run rate "$log" --block 200 -o "$work/2-blocks.csv" --json "$json"
  run fit "$log" --csv "$fit" -o "$work/2.txt"
  run simulate "$course/$name.toml" --set clock.dry_friction=2e-6 --seed 1 -o "$work/2-dry.csv"
  run rate "$work/2-dry.csv" --block 200 -o "$work/2-dry-blocks.csv"
  run simulate "$course/$name.toml" --seed 1 -o "$work/2-plain.csv"
  run rate "$work/2-plain.csv" --block 200 -o "$work/2-plain-blocks.csv"
  eps=$(truth $name epsilon) T=$(truth $name nominal_period) A=$(truth $name amplitude) N=$(truth $name periods)
  tau=$(calc %.6f "$T / (4 * pi * $eps)")
  lost=$(calc %.4f "$(json "$json" duration_s) - $T * $(json "$json" periods)")
  A0=$(fitted "$fit" lambda0 2) sigma=$(fitted "$fit" lambda0 3)
  table
  compare T0 "$T" "$fit"
  compare epsilon "$eps" "$fit"
  compare lambda0 "$A" "$fit"
  say
  say "- Q1. A²τ/16 (1 − e^(−t/τ)) with τ = $(calc %.1f "$tau") s:" \
    "$(calc %.3f "$A ^ 2 / 16 * $tau * (1 - exp(-$N * $T / $tau))") s."
  say "- Q2. It lost $lost s. The little that is missing: 0.2 is the velocity in the vertical (Q7), and the term in A⁴."
  say "- Q3. The rate is not constant, so a mean with an error bar answers no question; the 28 is the change of the" \
    "rate, not chance."
  awk -F, -v T="$T" 'NR > 1 {
      x = 1 / (1 + $6) - 1; t = $4 + $5 / 2; y = log(x); a = 4 * sqrt(x)
      if (NR == 2) first = a
      n++; st += t; sy += y; stt += t * t; sty += t * y; lasta = a
    }
    END {
      tau = -(n * stt - st * st) / (n * sty - st * sy); e = T / (4 * atan2(0, -1) * tau)
      printf "- Q4. %.3f rad in the first block, %.4f rad in the last: %.0f mm.\n", first, lasta, 1e3 * lasta
      printf "- Q5. τ = %.1f s, ε = %.2e, Q = %.0f by a line through the blocks. ", tau, e, 1 / (2 * e)
    }' "$work/2-blocks.csv" >> "$work/key.md"
  say "With T0 too large the points bend down at the late end, where the excess is only a few times the fault of T0."
  say "- Q6. Q = $(calc %.2f "1 / (2 * $(fitted "$fit" epsilon 2))"). $(calc %.1f "1e6 * $sigma") µrad, as many micrometres." \
    "The ruler is gravity: the angle is measured in radians by how much sin φ falls short of φ."
  say "- Q7. A = 2 asin(λ0/2) = $(calc '%.6f' "2 * atan2($A0 / 2, sqrt(1 - $A0 ^ 2 / 4))") rad," \
    "$(calc %.0f "1e6 * ($A ^ 3 / 24)") µrad more; the error of the fit is $(calc %.1f "1e6 * $sigma") µrad."
  awk -F, 'FNR == 1 {file++; k = 0} FNR > 1 {r[file, ++k] = $6}
    END {printf "- Q8. Without and with felt: first block %.3e and %.3e, last %.2e and %.2e. ", r[1, 1], r[2, 1], r[1, k], r[2, k]}' \
    "$work/2-plain-blocks.csv" "$work/2-dry-blocks.csv" >> "$work/key.md"
  say "It shows at the end: what it takes is constant, what linear friction takes shrinks with the swing. The line bends down."
  say "- Q9. Q ln 2/π = 0.22 Q = $(calc %.0f "log(2) / (2 * $eps * pi)") swings; half as many for the excess."
  say "- Q10. A²/16 = $(calc %.2e "(5 * pi / 180) ^ 2 / 16"): one beat in" \
    "$(calc %.0f "16 / (5 * pi / 180) ^ 2"). With a pulse that is itself steady to a part in two thousand."
}

jump() {
  local name=3-jump log fit eps T m0 m1 p lA lB rA rB rJ E
  log "$name"
  log=$folder/$name.csv fit=$work/3.csv
  run rate "$log" -o "$work/3-rates.csv"
  run rate "$log" --block 200 -o "$work/3-blocks.csv"
  run fit "$log" --fix T0=2 --event 150:mu --csv "$fit" -o "$work/3.txt"
  eps=$(truth $name epsilon) T=$(truth $name nominal_period) p=$(truth $name phi0)
  m0=$(truth $name mu) m1=$(truth $name mu last)
  lA=$(calc %.9g "sqrt(2 * $m0 * $p / (pi * $eps))") lB=$(calc %.9g "sqrt(2 * $m1 * $p / (pi * $eps))")
  E="2 / (pi * $lA) * sqrt(1 - ($p / $lA) ^ 2)"
  rA=$(calc %.9g "-$lA ^ 2 / 16 + $m0 * $E") rJ=$(calc %.9g "-$lA ^ 2 / 16 + $m1 * $E")
  rB=$(calc %.9g "-$lB ^ 2 / 16 + 2 * $m1 / (pi * $lB) * sqrt(1 - ($p / $lB) ^ 2)")
  table
  compare epsilon "$eps" "$fit"
  compare mu "$m0" "$fit"
  compare mu@1 "$m1" "$fit"
  compare phi0 "$p" "$fit"
  compare lambda0 "$(calc %.5f "$lA")" "$fit"
  say
  say "- Q1. Amplitude $(calc %.1f "1e3 * $lA") and $(calc %.1f "1e3 * $lB") mrad; rate $(calc %.1f "86400 * $rA")," \
    "$(calc %.1f "86400 * $rJ") and $(calc %.1f "86400 * $rB") s a day."
  say "- Q2. 4 Δμ φ0/λ = $(calc %.3f "4e3 * ($m1 - $m0) * $p / $lA") mrad, so many millimetres at 1 m. No."
  say "- Q3. In the amplitudes it drowns in their scatter (0.1 mrad); in the rates it is about fifteen times theirs."
  say "- Q4. Measured:"
  say
  for range in "1 150" "151 160" "1600 1800"; do
    awk -v from="${range% *}" -v to="${range#* }" -f "$course/between.awk" "$work/3-rates.csv" \
      | sed 's/^/      /' >> "$work/key.md"
  done
  say
  say "  The escapement error doubles, as the drive does, while the amplitude is still the old one."
  say "- Q5. The circular error grows with λ², and the escapement error falls about as 1/λ."
  awk -F, -v end="$lB" -v T="$T" 'NR > 1 && $4 > 300 && $4 < 1500 {
      t = $4 + $5 / 2; y = log(end ^ 2 - $9 ^ 2); n++; st += t; sy += y; stt += t * t; sty += t * y }
    END { tau = -(n * stt - st * st) / (n * sty - st * sy)
      printf "- Q6. %.0f s from the blocks between 300 and 1500 s, ε = %.2e. ", tau, T / (4 * atan2(0, -1) * tau) }' \
    "$work/3-blocks.csv" >> "$work/key.md"
  say "Expected $(calc %.1f "$T / (4 * pi * $eps)") s."
  say "- Q7. The creep tells ε; the rates before, at once after and long after give three equations for μ, μ@1 and φ0;" \
    "the amplitudes confirm them."
  awk -F, '$1 == 150 {first = $2} $1 == 1800 {last = $2} END {t = last - first
    printf "- Q8. Gained %.4f s. ", 1650 * 2 - t - 1.960e-4 * t}' "$work/3-rates.csv" >> "$work/key.md"
  say "The hump is $(calc %.2e "$rJ - $rB") high and lasts some $(calc %.0f "$T / (4 * pi * $eps)") s:" \
    "$(calc %.2f "($rJ - $rB) * $T / (4 * pi * $eps)") s. It falls a little more slowly than λ² settles; for ever it makes 0.094 s."
  say "- Q9. No: $(run map --solve epsilon=$eps mu=$m1 | awk 'END {printf "%.2f", $4}') and" \
    "$(run map --solve epsilon="$(calc %.9g "$eps / 2")" mu="$m0" | awk 'END {printf "%.2f", $4}') s a day. The better clock is" \
    "the oiled one, not because its rate is near zero (a nut sets that) but because half the friction halves the escapement" \
    "error that can vary."
  say "- Q10. ε does not stand in the rate. The time is T0/(4πε): with half the ε twice as long."
  say "- Q11. Drive: the rate jumps and the amplitude follows. Oil: both creep together. At the same amplitude in the end," \
    "the rates differ (Q9)."
}

noise() {
  local name=4-noise log eps T m p x l g0 gs fast slow tau day quiet xq lq
  log "$name"
  log=$folder/$name.csv
  eps=$(truth $name epsilon) T=$(truth $name nominal_period) m=$(truth $name mu) p=$(truth $name phi0)
  fast=$(truth $name fast_rms) slow=$(truth $name slow_rms) tau=$(truth $name slow_time) day=86400
  run stability "$log" -o "$work/4-oadev.txt"
  run spectrum "$log" --fix T0=$T --fix epsilon=$eps --fix mu=$m --fix phi0=$p > "$work/4.txt"
  x=$(calc %.9g "2 * $m / (pi * $eps * $p)")
  l=$(calc %.9g "$p * sqrt($x)")
  g0=$(calc %.9g "2 * $m / (pi * $l) * sqrt(1 - 1 / $x)")
  gs=$(calc %.9g "-$p ^ 2 / 16 * $x + $eps * $x / (2 * sqrt($x - 1))")
  xq=$(calc %.9g "1 + (8 * $eps / $p ^ 2) ^ 2")
  quiet=$(calc %.9g "$xq * pi * $eps * $p / 2")
  lq=$(calc %.9g "$p * sqrt($xq)")
  say
  say "| drive | truth | goingrate finds (68 %) |"
  say "|---|---|---|"
  say "| fast | $(calc %.0f "100 * $fast") % | $(sed -nE 's/^ *fast, white +//p' "$work/4.txt") |"
  say "| slow | $(calc %.0f "100 * $slow") % | $(sed -nE 's/^ *slow, with a memory +//p' "$work/4.txt") |"
  say
  say "- Q1. g_0 = $(calc %.3e "$g0"), g_∞ = $(calc %.3e "$gs"). After a day the fast noise makes" \
    "$(calc %.1f "1e3 * $gs * $fast * sqrt($T * $day)") ms, the slow one $(calc %.0f "1e3 * $gs * $slow * sqrt(2 * $tau * $day)") ms:" \
    "$(calc %.0f "$slow / $fast * sqrt(2 * $tau / $T)") times as much from a sixth of the variation."
  say "- Q2. $fast g_0 = $(calc %.3e "$fast * $g0"); the log has $(awk '$1 == 2 {print $4}' "$work/4-oadev.txt"). The jitter adds" \
    "√3 σ/τ in squares."
  say "- Q3. $(awk '$1 + 0 > 0 && (!best || $4 < best) {best = $4; at = $1} END {printf "%.1e at %d s", best, at}' "$work/4-oadev.txt")" \
    "in this log. That is the length to take: a shorter one is noisier, a longer one is about another drive."
  say "- Q4. There the errors of neighbouring periods cancelled; here each swing's rate is on its own."
  say "- Q5. About 9000 of the fast one, but only about 18000/(2·$tau) = $(calc %.1f "18000 / (2 * $tau)") of the slow one:" \
    "what is slower than the log looks like a constant."
  say "- Q6. The worksheet's forty days give 21 ms and 207 ms: within 11 % of Q1."
  say "- Q7. The slow one, by far. Halving its memory instead gains only a factor √2."
  say "- Q8. d/dμ = 0 gives φ0²/16 = ε/(2 √(x−1)). μ = $(calc %.2e "$quiet"), λ = $(calc %.1f "1e3 * $lq") mrad."
  say "- Q9. 207 ms become 17 ms: twelve times better. Left over:" \
    "$(calc %.1f "1e3 * 2 * $quiet / (pi * $lq) * sqrt(1 - 1 / $xq) * $slow * $T / (4 * pi * $eps)") ms, and it no longer grows" \
    "with time."
  say "- Q10. A constant rate is set to zero with the rating nut. A varying one cannot be."
  say "- Q11. What is averaged over many times its memory hardly counts; what lasts as long as you watch counts in full."
}

which_model() {
  local name=5-which-model log eps T A model fit d sd
  log "$name"
  log=$folder/$name.csv
  eps=$(truth $name epsilon) T=$(truth $name nominal_period) A=$(truth $name amplitude)
  run simulate "$course/$name.toml" --set start.amplitude=0.6 --seed 1 -o "$work/5-wide.csv"
  for model in averaged1 averaged2 map; do
    fit=$work/5-$model.csv
    run fit "$log" --model $model --csv "$fit" -o "$work/5-$model.txt"
    run fit "$work/5-wide.csv" --model $model --csv "$work/5-wide-$model.csv" -o /dev/null
    say
    say "With \`--model $model\`:"
    table
    compare T0 "$T" "$fit"
    compare epsilon "$eps" "$fit"
    compare lambda0 "$A" "$fit"
    [ -z "$(fitted "$fit" quadratic_drag 2)" ] || compare quadratic_drag 0 "$fit"
  done
  say
  say "(First order does not say which amplitude its lambda0 is; the largest angle is" \
    "$(calc %.5f "2 * atan2($A / 2, sqrt(1 - $A ^ 2 / 4))").)"
  fit=$work/5-averaged1.csv
  d=$(fitted "$fit" quadratic_drag 2) sd=$(fitted "$fit" quadratic_drag 3)
  say
  if [ -n "$d" ] && [ -n "$sd" ]; then
    say "- Q1. Drag $(off quadratic_drag 0 "$fit") sigma from nothing, ε" \
      "$(off epsilon "$eps" "$fit") sigma from the truth." \
      "Chi-squared: $(sed -nE 's/.*degrees of freedom \((p = [0-9.e-]+)\).*/\1/p' "$work/5-averaged1.txt"); whiteness:" \
      "$(sed -nE 's/.*are white with (p = [0-9.e-]+) .*/\1/p' "$work/5-averaged1.txt"). Nothing sticks out."
  else
    say "- Q1. This log shows no drag with averaged1."
  fi
  say "- Q2. $(sed -nE 's/.*BIC worse by ([0-9.,e+]+) .*/Linear friction alone is worse by \1./p' "$work/5-averaged1.txt" | sed -n 1p)" \
    "BIC compares what was tried; the right model was not among them."
  say "- Q3. First order has the wrong A⁴ in the rate, so the period falls in the wrong way as the swing shrinks. Drag makes the" \
    "swing shrink faster while it is wide; with a little less ε and a larger start the times come out."
  say "- Q4. To bend the decay so that a wrong law of the period gives the right times."
  say "- Q5. No. It is good enough for this log; a longer or sharper one would show it (task 5)."
  say "- Q6. The error of the log, the sigma. 14/0.2 times 1 ms: 70 ms."
  say "- Q7. No: ε has one meaning only, and is off by 2.7 sigma (T0 by 1.4). No test on the residuals can tell: the wrong parameters" \
    "explain the times as well as the right ones. Only a better theory tells, or a ruler."
  say "- Q8. The wrong term by 5⁴ = 625, the lever dr/dλ = λ/8 by 5. So λ0 is off by 125 times less, while its sigma is 5 times larger:" \
    "in sigma as A⁴, from 14 to 0.02."
  say "- Q9. ε²/2 of T0 is $(calc %.1e "$eps ^ 2 / 2 * $T") s; the sigma of T0 is 5.4e-07 s."
  for model in averaged2 map; do
    fit=$work/5-wide-$model.csv
    [ $model = map ] || say "- Q10. The wide log of the worksheet:"
    say "  \`$model\` is off by $(calc %+.1f "($(fitted "$fit" lambda0 2) - 0.6) / $(fitted "$fit" lambda0 3)") sigma."
  done
  say "- Q11. For instance: the model describes these data; what its parameters mean depends on errors it does not know of."
  say "- Q12. What the old analysis leaves out, compared with the new errors."
}

say "# Key for seed $seed"
say
say "Generated by \`data/course/key.sh $seed\`. \"Off by\" is (found − truth)/sigma: two in three should lie within ±1."
first_log
ring_down
jump
noise
which_model
mv "$work/key.md" "$key"
echo "$folder: five logs and key.md"
