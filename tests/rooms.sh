#!/usr/bin/env bash
# Each room includes only itself and those below it; Ceres and FFTW stay out of the public headers.
set -euo pipefail
cd "$1"
rooms=(base clock dynamics log spectra fit report)
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
exit $fault
