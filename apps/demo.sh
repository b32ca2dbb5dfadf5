#!/usr/bin/env bash
# Sets up, builds and reports on a log: ./apps/demo.sh [LOG [options of goingrate report]]
set -euo pipefail
here=$(pwd)
cd "$(dirname "$0")/.."
. apps/setup.sh
log=${1:-data/logs/interruption.csv}
[ $# -gt 0 ] && shift
case $log in
  /* | - ) ;;
  data/logs/*) [ -e "$log" ] || log="$here/$log" ;;
  *) log="$here/$log" ;;
esac
echo "Building (the first time takes a few minutes) ..." >&2
build_log=$(mktemp)
trap 'rm -f "$build_log"' EXIT
if ! { cmake --preset release -DBUILD_TESTING=OFF && cmake --build --preset release; } > "$build_log" 2>&1
then
  cat "$build_log" >&2
  exit 1
fi
name=$(basename "$log")
build/release/goingrate report "$log" -o "$here/${name%.*}.html" "$@"
