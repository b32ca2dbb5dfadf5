#!/usr/bin/env bash
# Usage: ten_years.sh [BEATS]
# Ten years of a seconds pendulum (1.58e8 beats if not given), a tenth and a hundredth of them: CPU time,
# elapsed time and the largest memory of `rate` (JSON, and with the table written), `stability` (times, and phases) and
# `report`. ten_years.txt holds the output of a run. Takes a quarter of an hour, and 15 GB of disk.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup time
built_command
head_line 20261201
cd "$here"
cat > log.cpp <<'CPP'
// A clock of 2 s with 10 us of jitter whose times walk; one beat in 1000 is missed, one event in 5000 is false.
// Arguments: beats, "times" or "phases".
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>
int main(int, char** arguments) {
  const long beats = std::atol(arguments[1]);
  const bool phases = std::string_view(arguments[2]) == "phases";
  std::mt19937_64 engine(20261201);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  double walk = 0.0;
  for (long n = 0; n < beats; ++n) {
    walk += 2e-6 * normal(engine);
    const double late = walk + 1e-5 * normal(engine);
    const long double time = 5.0L + 2.0L * n + late;
    if (phases)
      std::printf("%.12e\n", late);
    else if (uniform(engine) > 1e-3)
      std::printf("%.8Lf\n", time);
    if (!phases && uniform(engine) < 2e-4) std::printf("%.8Lf\n", time + 0.3L + uniform(engine));
  }
}
CPP
c++ -O2 -std=c++20 log.cpp -o log
beats=${1:-158000000}
measured() { # name, beats, command
  local name=$1 n=$2
  shift 2
  /usr/bin/time -o took -f '%U %S %e %M' "$@" > printed 2> errors || { cat errors; exit 1; }
  awk -v name="$name" -v n="$n" '{ printf "%-28s %11d %9.1f %9.1f %9.2f %11.0f %10.1f\n",
    name, n, $1 + $2, $3, $4 / 1048576, 1e9 * ($1 + $2) / n, 1024 * $4 / n }' took
}
printf '%-28s %11s %9s %9s %9s %11s %10s\n' command beats 'CPU s' 's' GiB 'ns a beat' 'B a beat'
for n in $((beats / 100)) $((beats / 10)) "$beats"; do
  ./log "$n" times > times
  measured 'rate --json' "$n" "$goingrate" --quiet rate times --json -
  measured 'rate -o table' "$n" "$goingrate" --quiet rate times -o table.csv
  rm table.csv
  measured 'stability, times' "$n" "$goingrate" --quiet stability times
  measured 'report' "$n" "$goingrate" --quiet report times -o page.html
  ./log "$n" phases > times
  measured 'stability, phases' "$n" "$goingrate" --quiet stability times --format phase --tau0 2
done
