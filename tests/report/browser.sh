#!/usr/bin/env bash
# browser.sh GOINGRATE SOURCE FOLDER [LOG]: the page of a report in headless Chromium. Its pictures stay
# in FOLDER, to be looked at.
set -euo pipefail
command=$1 source=$2 folder=$3
log=${4:-$source/data/logs/interruption.csv}
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
[ -n "$chromium" ] || { echo "no chromium here: skipped"; exit 77; }
command -v node > /dev/null || { echo "no node here: skipped"; exit 77; }
mkdir -p "$folder"
"$command" report "$log" -o "$folder/page.html" > /dev/null 2>&1
grep -q 'id="figure-data"' "$folder/page.html" \
  || { echo "the build had no plotly.js: skipped"; exit 77; }
echo "      $(stat -c %s "$folder/page.html") bytes"
exec node "$source/tests/report/browser.mjs" "$chromium" "$folder/page.html" "$folder"
