#!/usr/bin/env bash
# The .deb names the libraries it needs.
set -euo pipefail
cpack=$1 build=$2
command -v dpkg-shlibdeps > /dev/null || { echo "no dpkg-shlibdeps here: skipped"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$build"
"$cpack" -G DEB -B "$scratch" > "$scratch/cpack.log" || { cat "$scratch/cpack.log"; exit 1; }
deb=$(ls "$scratch"/goingrate_*.deb)
depends=$(dpkg-deb -f "$deb" Depends)
echo "Depends: $depends"
for library in libc6 libfftw3 libfmt libtomlplusplus; do
  grep -q "$library" <<< "$depends"
done
dpkg-deb -c "$deb" > "$scratch/list"
grep -q ' ./usr/bin/goingrate$' "$scratch/list"
