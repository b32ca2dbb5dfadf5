#!/usr/bin/env bash
# run.sh GOINGRATE SOURCE FOLDER [FORM]: the page that runs in a browser, in one of four forms.
# whole (if none is named): it is built into FOLDER; its numbers agree with those of the command GOINGRATE on logs of
#   all formats; it works in headless Chromium; it takes a million lines; cpack packages it.
# short: it is built; fewer logs, fewer parts.
# portable: every source is checked to pass the compiler of WebAssembly.
# replay: nothing is compiled to WebAssembly, and the page gives back what GOINGRATE wrote before. For those who have
#   a few minutes and no libraries yet.
# Pictures stay in FOLDER/pictures, to be looked at.
set -euo pipefail
goingrate=$(realpath "$1") source=$(realpath "$2") form=${4:-whole}
needed_here=(node)
[ "$form" = replay ] || needed_here+=(em++)
for needed in "${needed_here[@]}"; do
  command -v "$needed" > /dev/null || { echo "no $needed here: skipped"; exit 77; }
done
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
tests=$source/tests/web
mkdir -p "$3"
folder=$(realpath "$3")
page=$folder/goingrate.html

in_browser() {
  [ -n "$chromium" ] || { echo "no chromium here: the page is not opened"; return 0; }
  node "$tests/page.mjs" "$page" "$goingrate" "$source" "$folder/pictures" "$chromium" "$@"
}

if [ "$form" = portable ]; then
  exec "$tests/portable.sh" "$source" "$folder"
fi
if [ "$form" = replay ]; then
  node "$tests/replay.mjs" "$goingrate" "$source" "$folder"
  node "$source/apps/web/assemble.mjs" "$source" "$folder"
  "$tests/self_contained.sh" "$page"
  in_browser report hostile looks keyboard worksheets
  exit
fi
"$source/apps/web/build.sh"
"$tests/self_contained.sh" "$page"
if [ "$form" = short ]; then
  node "$tests/same_numbers.mjs" "$page" "$goingrate" "$source" "$folder/logs" 4
  in_browser report hostile looks
else
  node "$tests/same_numbers.mjs" "$page" "$goingrate" "$source" "$folder/logs"
  in_browser
  in_browser largest
  "$tests/package.sh" "$source" "$folder"
fi
