#!/usr/bin/env bash
# The rules of the house: each room includes only itself and those below it, Ceres and FFTW stay out of
# the public headers, and every test that a docstring names exists.
set -euo pipefail
cd "$1"
rooms=(base clock dynamics log spectra fit analysis report)
fault=0
for i in "${!rooms[@]}"; do
  for ((j = i + 1; j < ${#rooms[@]}; j++)); do
    if grep -rn "#include \"goingrate/${rooms[j]}/" "include/goingrate/${rooms[i]}" "src/${rooms[i]}"; then
      echo "room ${rooms[i]} must not know room ${rooms[j]}"
      fault=1
    fi
  done
done
if grep -rn '#include "goingrate/\(clock\|dynamics\|log\)/' include/goingrate/spectra src/spectra; then
  echo "room spectra works on spans: it knows nothing of clocks and logs"
  fault=1
fi
if grep -rnE '#include <(ceres|fftw3)' include; then
  echo "a public header includes Ceres or FFTW"
  fault=1
fi
for library in 'ceres/' fftw3; do
  count=$(grep -rlE "#include <$library" src | wc -l)
  if [ "$count" -gt 2 ]; then
    echo "$count sources include $library; one or two should"
    fault=1
  fi
done
while read -r name; do
  suite=${name%%.*} test=${name#*.}
  if ! grep -rqE "TEST(_F|_P)?\($suite, $test\)" tests; then
    echo "a header names the test $name, which does not exist"
    fault=1
  fi
done < <(grep -rhoE '\b[A-Z][A-Za-z0-9]+\.[A-Z][A-Za-z0-9]{5,}\b' include | grep -vE '^(README|NIST)\.' | sort -u)
exit $fault
