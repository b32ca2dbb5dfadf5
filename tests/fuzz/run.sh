#!/usr/bin/env bash
# Fuzzes the reader and the scenario file, SECONDS in all (60 if not given), from the committed corpus.
# New inputs go to build/fuzz/found-*; a crash is left in build/fuzz. Exit 77: no clang or libFuzzer.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${1:-60}
build=${2:-../../build/fuzz}
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' > "${TMPDIR:-/tmp}/goingrate-fuzz-$$.cpp"
trap 'rm -f "${TMPDIR:-/tmp}/goingrate-fuzz-$$".*' EXIT
if ! clang++ -fsanitize=fuzzer "${TMPDIR:-/tmp}/goingrate-fuzz-$$.cpp" -o "${TMPDIR:-/tmp}/goingrate-fuzz-$$.out" 2> /dev/null; then
  echo "clang++ with libFuzzer is not there (Debian: clang libclang-rt-14-dev): nothing was fuzzed"
  exit 77
fi
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER=clang++ > /dev/null
cmake --build "$build" -j2 | tail -1
here=$PWD
cd "$build"
for target in reader scenario; do
  mkdir -p "found-$target"
  # Ten seconds for one input is a hang; memory is held against the input by the targets themselves.
  ./fuzz_$target -max_total_time=$((seconds / 2)) -timeout=10 -rss_limit_mb=2048 -max_len=16384 \
    -print_final_stats=1 -dict="$here/$target.dict" "found-$target" "$here/corpus/$target" 2> "$target.log" \
    || { tail -40 "$target.log"; exit 1; }
  grep -E 'stat::(number_of_executed_units|peak_rss_mb)|DONE' "$target.log" | sed "s/^/$target: /"
done
