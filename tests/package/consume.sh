#!/usr/bin/env bash
# An outside project finds the installed library by find_package and runs.
set -euo pipefail
cmake=$1 build=$2 source=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$cmake" --install "$build" --prefix "$scratch/prefix" > "$scratch/install.log"
"$cmake" -S "$source" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DCMAKE_BUILD_TYPE=Release > "$scratch/configure.log" || { cat "$scratch/configure.log"; exit 1; }
"$cmake" --build "$scratch/build"
printed=$("$scratch/build/consumer")
echo "printed $printed"
[ "$printed" = "1.133264e-04" ] # the exact rate at A
"$scratch/prefix/bin/goingrate" --version
# What the page draws with travels inside the command.
if [ -s "$build/src/plotly-basic.min.js" ]; then
  grep -q 'plotly.js (basic' "$scratch/prefix/bin/goingrate"
fi
