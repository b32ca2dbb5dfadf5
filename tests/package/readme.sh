#!/usr/bin/env bash
# Checks what README.md and the guide print. Every `sh` block and every `goingrate ...` between backticks is run
# as printed, in a folder with my.log and the project's data. The lines of an `output` block must be printed, in
# that order, by the block before it; README.md shows all lines, except those replaced by a line of three dots.
# Scenarios (`toml`) and files of parameters (`par`) are read by the command. Options, files, links and tests
# that are named exist. (The C++ and CMake of the guide are built by consume.sh.)
# readme.sh SOURCE GOINGRATE [--mend]: with --mend, README.md is given the output that is printed.
set -uo pipefail
source=$(realpath "$1") goingrate=$(realpath "$2") mend=${3:-}
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
mkdir "$here/bin" "$here/blocks" "$here/root"
ln -s "$goingrate" "$here/bin/goingrate"
ln -s "$source/data" "$source/apps" "$here/root"
cp "$source/data/logs/jump.csv" "$here/root/my.log"
cd "$here/root" || exit 1
export PATH="$here/bin:$PATH" LC_ALL=C.UTF-8
faults=0 page=

fault() {
  echo "$page: $*"
  faults=$((faults + 1))
}

run() { # COMMAND ...: as printed
  "$@" > "$here/out" 2> "$here/err" < my.log || { fault "$*: exit $?"; tail -n 5 "$here/err"; }
}

# blocks/LINE.KIND, LINE being where the block begins; an `output` block has the line of its `sh` block.
split_blocks() {
  awk -v to="$here/blocks/" '
    /^```/ {
      if (inside) { inside = 0; close(file); next }
      inside = 1
      kind = substr($0, 4)
      if (kind == "sh") before = NR
      file = to sprintf("%04d", kind == "output" ? before : NR) "." (kind == "" ? "text" : kind)
      printf "" > file
      next
    }
    inside { print > file }' "$source/$page"
}

# compare EXPECTED FOUND: says where they part.
compare() {
  awk -v whole="$([ "$page" = README.md ] && echo 1)" '
    BEGIN { free = !whole }
    { sub(/[ \t]+$/, "") }
    NR == FNR { found[++n] = $0; next }
    $0 == "..." { free = 1; next }
    {
      if (free) while (at < n && found[at + 1] != $0) ++at
      if (found[++at] != $0) { print "expected: " $0; if (!free) print "found:    " found[at]; bad = 1; exit 1 }
      free = !whole
    }
    END { if (!bad && !free && at < n) { print "also printed: " found[at + 1]; exit 1 } }' "$2" "$1"
}

run_blocks() {
  local block expected
  for block in "$here"/blocks/*.sh; do
    [ -e "$block" ] || return
    bash -euo pipefail "$block" > "${block%.sh}.found" 2> "$here/err" \
      || { fault "line $((10#$(basename "$block" .sh))): the command failed"; tail -n 5 "$here/err"; }
    blocks=$((blocks + 1))
    expected=${block%.sh}.output
    [ -e "$expected" ] || continue
    if [ "$mend$page" = --mendREADME.md ] && ! grep -qx '\.\.\.' "$expected"; then
      sed -i 's/[[:blank:]]*$//' "${block%.sh}.found"
    else
      compare "$expected" "${block%.sh}.found" > "$here/parts" \
        || { fault "line $((10#$(basename "$block" .sh))): what the command prints is other"; cat "$here/parts"; }
    fi
  done
}

# Puts what was printed where the page has an output block without dots.
mend_page() {
  awk -v from="$here/blocks/" '
    function shown(file,   line) { while ((getline line < file) > 0) print line; close(file) }
    function dotted(file,   line, dots) { while ((getline line < file) > 0) if (line == "...") dots = 1; close(file); return dots }
    /^```/ {
      if (inside) { inside = 0; skip = 0 }
      else {
        inside = 1
        if ($0 == "```sh") before = from sprintf("%04d", NR)
        if ($0 == "```output" && !dotted(before ".output")) { print; shown(before ".found"); skip = 1; next }
      }
    }
    !skip' "$source/$page" > "$here/mended"
  cmp -s "$here/mended" "$source/$page" || { cp "$here/mended" "$source/$page"; echo "$page: mended"; }
}

prose() { awk '/^ *```/ { inside = !inside; next } !inside' "$source/$page"; }

# What stands between backticks, outside of blocks.
spans() { prose | grep -oE '`[^`]+`' | tr -d '`' | sort -u; }

# A word in capitals stands for something: such a line is no command to run.
run_spans() {
  local line
  while IFS= read -r line; do
    grep -qxF -- "$line" "$here/ran" && continue
    echo "$line" >> "$here/ran"
    # shellcheck disable=SC2086
    run $line
    examples=$((examples + 1))
  done < <(spans | grep '^goingrate ' | grep -vE '\b[A-Z]{3,}\b|^goingrate( [a-z]+)*$')
}

check_names() {
  # These two pages name options of other programs as well.
  local bare=--
  [[ $page != data/guide/batch.md && $page != data/guide/python.md ]] || bare='goingrate '
  local option name target folder
  folder=$(dirname "$source/$page")
  while IFS= read -r option; do
    grep -qwF -- "$option" "$here/options" || fault "no command has the option $option"
  done < <(spans | grep -E "^(goingrate |$bare)" | grep -oE -- '--[a-z][a-z0-9-]*' | sort -u)
  while IFS= read -r name; do
    compgen -G "$source/$name" > /dev/null || compgen -G "$source/$name.*" > /dev/null \
      || fault "there is no $name"
  done < <(spans | grep -oE '^(tests|data|apps|src|include)/[A-Za-z0-9_./*-]+' | grep -vE '[A-Z]{3,}(/|\.|$)' | sort -u)
  while IFS= read -r target; do
    [ -e "$folder/$target" ] || fault "the link $target leads nowhere"
  done < <(prose | grep -oE '\]\([^)#]+' | cut -c3- | grep -vE '^https?:' | sort -u)
  while IFS= read -r name; do
    [ -x "$source/$name" ] || fault "there is no script $name"
  done < <(cat "$here"/blocks/*.console 2> /dev/null | grep -oE '^\./[a-z./]+' | sort -u)
  while IFS= read -r name; do
    grep -rqE "TEST(_F|_P)?\($name|NAME $name" "$source/tests" || fault "there is no test $name"
  done < <(grep -oE '`ctest`( and| `[A-Za-z.]+`,?)+' "$source/$page" | grep -oE '`[A-Z][A-Za-z.]+`' | tr -d '`' | sed 's/\./, /' | cut -d, -f1 | sort -u)
}

: > "$here/ran"
for command in simulate rate fit spectrum stability report compare map chart paper batch monitor help; do
  goingrate "$command" --help
done | grep -oE -- '--[a-z][a-z0-9-]*' | sort -u > "$here/options"
printf '%s\n' --help --version --quiet >> "$here/options"

blocks=0 examples=0 pages=0
for page in README.md CONTRIBUTING.md CHANGELOG.md $(cd "$source" && ls data/guide/*.md); do
  rm -f "$here"/blocks/*
  split_blocks
  run_blocks
  [ "$mend$page" != --mendREADME.md ] || mend_page
  # What can be run on the page on Python is run by the tests of the package.
  [ "$page" = data/guide/python.md ] || run_spans
  for file in "$here"/blocks/*.toml; do
    [ ! -e "$file" ] || run goingrate simulate "$file" --set run.periods=300 -o all.csv
  done
  for file in "$here"/blocks/*.par; do
    [ ! -e "$file" ] || run goingrate fit my.log --from "$file"
  done
  check_names
  pages=$((pages + 1))
done

page=README.md
[ "$(wc -l < "$source/README.md")" -le 150 ] || fault "longer than 150 lines: it is the door"
page=data/guide/architecture.md
while IFS= read -r name; do
  compgen -G "$source/include/goingrate/$name.hpp" > /dev/null || compgen -G "$source/src/$name*" > /dev/null \
    || compgen -G "$source/$name*" > /dev/null || fault "there is no $name"
done < <(grep -E '^\| [a-z]' "$source/$page" | grep -oE '`[a-z]+/[a-z0-9_.]+`' | tr -d '`' | sort -u)
page=data/guide/json.md
cat rate.json fit.json spectrum.json deviation.json > "$here/keys"
while IFS= read -r key; do
  grep -qF "\"$key\"" "$here/keys" || fault "no result has the key $key"
done < <(grep -oE '^\| (`[A-Za-z0-9_]+`(, )?)+' "$source/$page" | grep -oE '`[A-Za-z0-9_]+`' | tr -d '`' | grep -vx decay)
page=data/guide/formats.md
for format in $(goingrate rate --help | tr -d '\n ' | grep -oE -- '--formatTEXT:\{[^}]*' | cut -d'{' -f2 | tr , ' '); do
  grep -qF "| \`$format\` |" "$source/$page" || fault "has no line on the format $format"
done
# The recipe for a friction law names every file in which an existing one stands.
page=CONTRIBUTING.md
while IFS= read -r name; do
  grep -qF "$name" "$source/$page" || fault "the recipe for a friction law leaves out $name"
done < <(cd "$source" && grep -rlE '\bquadratic(_drag)?\b' include src apps --include='*.cpp' --include='*.hpp' --include='*.py' |
  grep -vE '^(src/log|include/goingrate/log)/')
[ "$blocks" -ge 8 ] && [ "$examples" -ge 12 ] || fault "only $blocks blocks and $examples examples"

[ "$faults" -eq 0 ] || exit 1
echo "$blocks blocks and $examples examples of $pages pages run as printed."
