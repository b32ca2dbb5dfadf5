#!/usr/bin/env bash
# What a newcomer does first: a clean checkout of the commit configures, and apps/demo.sh ends with a page. The
# demo runs in this checkout, where the build is up to date; in CI tests/run.sh runs it from scratch.
# demo.sh SOURCE BUILD
set -euo pipefail
source=$(realpath "$1") build=$(realpath "$2")
[ "$build" = "$source/build/release" ] || { echo "this is not build/release: skipped"; exit 77; }
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
# Nothing is installed by a test.
mkdir "$here/bin"
printf '#!/bin/sh\necho installed\n' > "$here/bin/dpkg-query"
chmod +x "$here/bin/dpkg-query"
export PATH="$here/bin:$PATH"

if git -C "$source" rev-parse --git-dir > /dev/null 2>&1; then
  git clone --quiet "$source" "$here/clone"
  # CMake finds out if a source is not in the commit; the headers are looked for here.
  cmake -S "$here/clone" -B "$here/clone/build" -G Ninja -DBUILD_TESTING=OFF -DGOINGRATE_PLOTLY=OFF \
    > "$here/log" 2>&1 || { cat "$here/log"; exit 1; }
  cd "$here/clone"
  grep -rhoE '#include "goingrate/[^"]+"' include src apps | sort -u | cut -d'"' -f2 \
    | while read -r header; do
      [ -e "include/$header" ] || { echo "$header is not in the commit"; exit 1; }
    done
  cd "$source"
fi

testing_before=$(grep '^BUILD_TESTING:' "$build/CMakeCache.txt")
cp "$source/data/logs/jump.csv" "$here/my.log"
(cd "$here" && "$source/apps/demo.sh" my.log --quiet) > "$here/said"
grep -qE '^  rate over the whole log, end to end +\+18\.42 ± ' "$here/said" || { cat "$here/said"; exit 1; }
grep -q '</html>' "$here/my.html"
[ "$testing_before" = "$(grep '^BUILD_TESTING:' "$build/CMakeCache.txt")" ] \
  || { echo "the demo changed how the tests are built"; exit 1; }
echo "The demo wrote a page of $(stat -c %s "$here/my.html") bytes."
