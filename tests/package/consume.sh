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
# The guide's lines for a project of one's own, with no more than a main around them.
block() { awk -v begin="\`\`\`$1" '$0 == begin { inside = 1; next } /^```/ { inside = 0 } inside' "$guide"; }
guide=$source/../../data/guide/library.md
mkdir "$scratch/mine"
{
  echo 'cmake_minimum_required(VERSION 3.25)'
  echo 'project(mine LANGUAGES CXX)'
  echo 'add_executable(mine main.cpp)'
  block cmake
} > "$scratch/mine/CMakeLists.txt"
{
  block cpp | grep '^#'
  echo 'int main() {'
  block cpp | grep -v '^#'
  echo 'return cycle->rate_excess > 0.0 ? 0 : 1; }'
} > "$scratch/mine/main.cpp"
"$cmake" -S "$scratch/mine" -B "$scratch/mine/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" > "$scratch/mine.log" \
  || { cat "$scratch/mine.log"; exit 1; }
"$cmake" --build "$scratch/mine/build"
"$scratch/mine/build/mine"
# What the page draws with travels inside the command.
if [ -s "$build/src/plotly-basic.min.js" ]; then
  grep -q 'plotly.js (basic' "$scratch/prefix/bin/goingrate"
fi
