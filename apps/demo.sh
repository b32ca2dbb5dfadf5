#!/usr/bin/env bash
# Sets up, builds and reports on a log: ./apps/demo.sh [LOG [options of goingrate report]]
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
echo "Building (the first time takes a few minutes) ..." >&2
build_log=$(mktemp)
trap 'rm -f "$build_log"' EXIT
# The tests need more packages and time; where they are built already they stay.
[ -e build/release/CMakeCache.txt ] || without_tests=-DBUILD_TESTING=OFF
# A newer compiler may warn of more; only the project's own checks insist.
insist=${CI:+-DGOINGRATE_WARNINGS_AS_ERRORS=ON}
if ! { cmake --preset release ${without_tests:-} ${insist:-} \
  && cmake --build --preset release --target goingrate_command; } > "$build_log" 2>&1
then
  cat "$build_log" >&2
  exit 1
fi
build/release/goingrate report "$log" -o "$page" "$@"
