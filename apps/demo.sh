#!/usr/bin/env bash
# Sets up, builds and reports on a log: ./apps/demo.sh [LOG [options of goingrate report]]
# The page is written to the folder you are in, under the log's name.
set -euo pipefail
here=$(pwd)
cd "$(dirname "$0")/.."
. apps/setup.sh
goingrate_setup
if [ $# -eq 0 ]; then
  log=data/logs/interruption.csv
  page=build/interruption.html
else
  log=$1
  shift
  [[ $log == /* ]] || log=$here/$log
  name=$(basename "$log")
  page=$here/${name%.*}.html
fi
build_log=$(mktemp)
trap 'rm -f "$build_log"' EXIT
# The tests need more packages and time; where they are built already they stay.
[ -e build/release/CMakeCache.txt ] || without_tests=-DBUILD_TESTING=OFF
# A newer compiler may warn of more; only the project's own checks insist.
insist=${CI:+-DGOINGRATE_WARNINGS_AS_ERRORS=ON}
build() {
  cmake --preset release ${without_tests:-} ${insist:-} \
    && cmake --build --preset release --target goingrate_command
}
# Says how far the build is, and nothing where all is built.
progress() {
  local line told=
  while IFS= read -r line; do
    case $line in "["*"] Building "* | "["*"] Linking "*) ;; *) continue ;; esac
    [ -n "$told" ] || echo "Building (the first time takes 5 to 20 minutes) ..." >&2
    told=1
    [ ! -t 2 ] || printf '\r%s ' "${line%%]*}]" >&2
  done
  [ -z "$told" ] || [ ! -t 2 ] || printf '\r%20s\r' '' >&2
}
if ! build 2>&1 | tee "$build_log" | progress; then
  cat "$build_log" >&2
  exit 1
fi
sed -n 's/^-- \(No plotly.js\)/\1/p' "$build_log" >&2
build/release/goingrate report "$log" -o "$page" "$@"
