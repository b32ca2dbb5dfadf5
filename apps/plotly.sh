#!/usr/bin/env bash
# plotly.sh FOLDER: leaves plotly-basic.min.js in FOLDER, from the npm registry unless it is there
# already. The build runs it and embeds the file into the library. Fails, with a word on why, if there
# is no npm or no network or if what came is not what was pinned.
set -euo pipefail
version=4.1.1
checksum=99784e3abfb07b142a15e521a439e6d9addceadb3f79553fd24c72774f0649ba # sha256 of the script
name=plotly-basic.min.js
mkdir -p "$1"
cd "$1"
is_right() { [ -f "$1" ] && echo "$checksum  $1" | sha256sum --check --status; }
is_right "$name" && exit 0
command -v npm > /dev/null || { echo "there is no npm here" >&2; exit 1; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
npm pack --silent --fetch-retries=1 --fetch-timeout=20000 --pack-destination "$scratch" \
  "plotly.js-basic-dist-min@$version" > /dev/null 2>&1 \
  || { echo "npm could not fetch plotly.js-basic-dist-min $version" >&2; exit 1; }
tar -xzf "$scratch"/*.tgz -C "$scratch" "package/$name"
is_right "$scratch/package/$name" \
  || { echo "plotly.js-basic-dist-min $version is not the one that was pinned" >&2; exit 1; }
mv "$scratch/package/$name" "$name"
