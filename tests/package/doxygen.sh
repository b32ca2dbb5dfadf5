#!/usr/bin/env bash
# The documentation of the library: Doxygen makes it without a warning, and every type and function of a
# public header is documented. Members whose name is enough need no text, nor do comparisons and moves.
# doxygen.sh CMAKE BUILD
set -euo pipefail
cmake=$1 build=$(realpath "$2")
[ -e "$build/Doxyfile.docs" ] || { echo "no Doxygen here: skipped"; exit 77; }
"$cmake" --build "$build" --target docs
[ -s "$build/docs/html/index.html" ]
grep -q 'goingrate reads that log' "$build/docs/html/index.html" \
  || { echo "the README is not the main page"; exit 1; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
{
  cat "$build/Doxyfile.docs"
  printf '%s\n' EXTRACT_ALL=NO WARN_AS_ERROR=NO GENERATE_HTML=NO GENERATE_XML=YES \
    "OUTPUT_DIRECTORY=$scratch" "WARN_LOGFILE=$scratch/warnings"
} > "$scratch/Doxyfile"
doxygen "$scratch/Doxyfile"
if grep 'not documented' "$scratch/warnings" \
  | grep -vE '\((variable|enumvalue)\) of|operator(==|<=>)|&&\) noexcept'; then
  echo "a public type or function has no text"
  exit 1
fi
echo "$(ls "$build/docs/html" | wc -l) files of documentation."
