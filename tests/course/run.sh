#!/usr/bin/env bash
# Runs the course in data/course as a student would: every ```sh block of every worksheet as printed, from a
# copy of the repository's root. Each line of the ```output block behind it must appear in what it prints,
# blanks counting as one. Also: the ready logs are what the scenarios give, and the teacher's key for a seed.
# run.sh ROOT BINARY
set -euo pipefail
root=$(cd "$1" && pwd)
binary=$(realpath "$2")
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
mkdir -p "$here/bin" "$here/blocks" "$here/root/data"
ln -s "$binary" "$here/bin/goingrate"
cp -r "$root/data/course" "$here/root/data/course"
cd "$here/root"
export PATH="$here/bin:$PATH" LC_ALL=C
faults=0

fault() {
  echo "$*"
  faults=$((faults + 1))
}

# WORKSHEET -> blocks/NAME.LINE.sh, and blocks/NAME.LINE.expect with "line<tab>text"; names what is out of place.
split_blocks() {
  awk -v stem="$here/blocks/$(basename "$1" .md)" '
    /^```/ {
      if (inside != "") { inside = ""; next }
      inside = substr($0, 4)
      if (inside == "sh") { block = sprintf("%s.%04d", stem, NR); printf "" > (block ".sh"); answered = 0 }
      else if (inside == "output" && block != "" && !answered) answered = 1
      else { print NR ": a block that is neither sh nor the output of one: " $0; inside = "other" }
      next
    }
    inside == "sh" { print > (block ".sh") }
    inside == "output" { print NR "\t" $0 > (block ".expect") }
    END { if (inside != "") print NR ": a block without end" }' "$1"
}

everything_else() { # what a worksheet must leave alone
  find . -path ./course-out -prune -o -type f -print | sort | xargs cksum
}

squeeze() { sed -E 's/[[:blank:]]+/ /g; s/^ //; s/ $//'; }

for sheet in data/course/[1-9]-*.md; do
  name=$(basename "$sheet" .md)
  while IFS= read -r complaint; do fault "$sheet:$complaint"; done < <(split_blocks "$sheet")
  everything_else > "$here/before"
  count=0
  for block in "$here/blocks/$name".*.sh; do
    [ -e "$block" ] || break
    count=$((count + 1))
    line=$(basename "$block" .sh)
    line=$((10#${line##*.}))
    if ! bash -euo pipefail "$block" > "$here/out" 2>&1; then
      fault "$sheet:$line: the command failed:"
      tail -n 5 "$here/out"
    fi
    squeeze < "$here/out" > "$here/squeezed"
    [ -e "${block%.sh}.expect" ] || continue
    while IFS=$'\t' read -r at text; do
      grep -qF -- "$(squeeze <<< "$text")" "$here/squeezed" \
        || fault "$sheet:$at: not in the output of the command in line $line: $text"
    done < "${block%.sh}.expect"
  done
  [ "$count" -ge 3 ] || fault "$sheet: only $count commands found"
  everything_else | cmp -s - "$here/before" || fault "$sheet: writes outside course-out"
  rm -rf course-out
done

for scenario in data/course/[1-9]-*.toml; do
  log=${scenario%.toml}.csv
  goingrate --quiet simulate "$scenario" --seed 1 -o "$here/again.csv"
  [ "$(wc -c < "$log")" -lt 150000 ] || fault "$log: larger than 150 kB"
  # Another compiler may round the last digit of a time the other way.
  paste -d, "$log" "$here/again.csv" | awk -F, '
    /^[0-9]/ { half = NF / 2; if (NF % 2) bad = 1; for (i = 1; i <= half; i++) if (($i - $(i + half)) ^ 2 > 1e-14) bad = 1 }
    /^,|,,/ { bad = 1 }
    END { exit bad }' || fault "$log: is not what $scenario gives with --seed 1"
done

if data/course/key.sh 7 course-out/key-7 > "$here/out" 2>&1; then
  for n in 1 2 3 4 5; do
    ls course-out/key-7/$n-*.csv > "$here/logs" 2>&1 || fault "data/course/key.sh: no log for worksheet $n"
    grep -q "^## $n\. " course-out/key-7/key.md || fault "data/course/key.sh: no answers for worksheet $n"
  done
  if grep -nwE '\| *\||-?nan|-?inf' course-out/key-7/key.md; then
    fault "data/course/key.sh: an empty answer"
  fi
else
  fault "data/course/key.sh 7 failed:"
  tail -n 5 "$here/out"
fi

[ "$faults" -eq 0 ] || exit 1
echo "The course runs as printed."
