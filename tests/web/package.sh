#!/usr/bin/env bash
# package.sh SOURCE FOLDER: cpack puts FOLDER/goingrate.html into a package of its own, for every architecture.
set -euo pipefail
source=$1 folder=$2
command -v dpkg-shlibdeps > /dev/null || { echo "no dpkg-dev here: the package is not tried"; exit 0; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --build "$source/build/release" -j "$(nproc)" > "$scratch/build.log" || { tail "$scratch/build.log"; exit 1; }
(cd "$source/build/release" && cpack -G DEB -B "$scratch/debs" > "$scratch/cpack.log") || { cat "$scratch/cpack.log"; exit 1; }
deb=$(ls "$scratch"/debs/goingrate-web_*_all.deb)
dpkg-deb -x "$deb" "$scratch/web"
cmp "$scratch/web/usr/share/goingrate/goingrate.html" "$folder/goingrate.html"
[ "$(find "$scratch/web" -type f | wc -l)" -eq 1 ]
[ -z "$(dpkg-deb -f "$deb" Depends)" ]
dpkg-deb -c "$scratch"/debs/goingrate_*.deb > "$scratch/list"
! grep -q 'goingrate[.]html' "$scratch/list"
echo "ok    $(basename "$deb") holds the page alone"
