#!/usr/bin/env bash
# run.sh [SECONDS [BUILD]]: fuzzes the reader, the scenario file and recordings of sound, SECONDS in all (60 if not given),
# from the committed corpus. Everything it writes is in BUILD (build/fuzz): new inputs in found-*, crashes,
# logs. Exit 77: no clang or no libFuzzer.
set -euo pipefail
seconds=${1:-60}
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "${2:-$here/../../build/fuzz}"
build=$(cd "${2:-$here/../../build/fuzz}" && pwd)
cd "$build"
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' > probe.cpp
if ! clang++ -fsanitize=fuzzer probe.cpp -o probe 2> probe.log; then
  echo "clang++ with libFuzzer is not there (Debian: clang libclang-rt-dev): nothing was fuzzed"
  exit 77
fi
cmake -S "$here" -B . -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER=clang++ > cmake.log
cmake --build . -j2 > build.log || { tail -40 build.log; exit 1; }
for target in reader scenario sound; do
  mkdir -p "found-$target"
  # Ten seconds for one input is a hang; memory is held against the input by the targets themselves.
  ./fuzz_$target -max_total_time=$((seconds / 3)) -timeout=10 -rss_limit_mb=2048 -max_len=65536 \
    -print_final_stats=1 -dict="$here/$target.dict" "found-$target" "$here/corpus/$target" 2> "$target.log" \
    || { tail -40 "$target.log"; exit 1; }
  grep -E 'stat::(number_of_executed_units|peak_rss_mb)|DONE' "$target.log" | sed "s/^/$target: /"
done
