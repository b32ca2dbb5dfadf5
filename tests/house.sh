#!/usr/bin/env bash
# Checks the rules of the house: each room includes only itself and those below it, only headers that users
# need are installed, without Ceres and FFTW, the library does not know the command, constants are named by
# nouns, and every test that a docstring names exists. Argument: the folder of the project.
set -euo pipefail
cd "$1"
rooms=(base clock dynamics sound log spectra fit drive causes analysis report)
fault=0
for i in "${!rooms[@]}"; do
  for ((j = i + 1; j < ${#rooms[@]}; j++)); do
    if grep -rnE "#include \"(goingrate/)?${rooms[j]}/" "include/goingrate/${rooms[i]}" "src/${rooms[i]}"; then
      echo "room ${rooms[i]} must not know room ${rooms[j]}"
      fault=1
    fi
  done
done
for folder in include/goingrate/*/ src/*/; do
  if [[ ! " ${rooms[*]} " =~ " $(basename "$folder") " ]]; then
    echo "$folder is no room"
    fault=1
  fi
done
if grep -rn '#include "\.\./' src include apps; then
  echo "another room is included by its name, not by a way to it"
  fault=1
fi
if grep -rnE '#include "(base|clock|dynamics|sound|log|spectra|fit|drive|causes|analysis|report)/' include; then
  echo "an installed header includes one that is not installed"
  fault=1
fi
if ! diff <(cd include && find goingrate -mindepth 2 -name '*.hpp' | LC_ALL=C sort) \
  <(sed -n 's/^#include "\(.*\)"$/\1/p' include/goingrate/goingrate.hpp | LC_ALL=C sort); then
  echo "include/goingrate/goingrate.hpp is not the list of installed headers"
  fault=1
fi
if grep -nE '!\[[^]]*$' README.md CHANGELOG.md CONTRIBUTING.md data/guide/*.md; then
  echo "an image's text goes over two lines, which Doxygen does not read"
  fault=1
fi
# Options of the command, from where it defines them; a string of the library names none.
options=$(grep -rhoE '"(-[a-z],)?--[a-z][a-z-]+' apps/*.cpp | grep -oE -- '--[a-z-]+' | sort -u | paste -sd'|')
if grep -rnE "^[^/]*\".*($options)\b" src include --include='*.cpp' --include='*.hpp'; then
  echo "the library names an option of the command"
  fault=1
fi
if grep -rn '#include "goingrate/\(clock\|dynamics\|log\)/' include/goingrate/spectra src/spectra; then
  echo "room spectra works on spans: it knows nothing of clocks and logs"
  fault=1
fi
if grep -rnE '#include <(ceres|fftw3)' include; then
  echo "a public header includes Ceres or FFTW"
  fault=1
fi
# `enough` does not say of what: a limit, a count, a share.
adjectives='enough|near|close|clear|many|few|little|alike|same|surely|brief|apart|around|far|badly|much|small|large'
if grep -rnE "\bconstexpr [^;/]*\b($adjectives) *[={]" src include apps tests --include='*.cpp' --include='*.hpp'; then
  echo "a constant is named by an adjective: say what it is, and its unit"
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
