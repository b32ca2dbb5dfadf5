#!/usr/bin/env bash
# browser.sh GOINGRATE SOURCE FOLDER [LOG]: the page of a report in headless Chromium, and briefly the page for
# 432,000 beats. Its pictures are kept in FOLDER, to be looked at.
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
node "$source/tests/report/browser.mjs" "$chromium" "$folder/page.html" "$folder"

# A day of a watch's ticks: still a page that a mail takes.
awk 'BEGIN { srand(1); print "# nominal_period_s: 0.2"; print "time_s"
  for (i = 0; i < 432000; ++i) printf "%.7f\n", 0.199998 * i + 4e-5 * (rand() + rand() + rand() - 1.5) }' \
  > "$folder/ticks.csv"
"$command" report "$folder/ticks.csv" -o "$folder/ticks.html" > /dev/null 2>&1
rm "$folder/ticks.csv"
bytes=$(stat -c %s "$folder/ticks.html")
echo "      432,000 ticks: $bytes bytes"
[ "$bytes" -lt 5000000 ] || { echo "FAULT the page of a day of ticks has 5 MB or more"; exit 1; }
exec node "$source/tests/report/browser.mjs" "$chromium" "$folder/ticks.html" "$folder" brief
