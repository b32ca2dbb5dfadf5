#!/usr/bin/env bash
# What the README shows is run as it stands: the examples of its table, its scenario, its file of
# parameters; the scripts it names exist. (Its C++ and CMake are built by consume.sh.)
# readme.sh SOURCE GOINGRATE
set -uo pipefail
source=$(realpath "$1") goingrate=$(realpath "$2")
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
mkdir "$here/bin"
ln -s "$goingrate" "$here/bin/goingrate"
ln -s "$source/data" "$here/data"
cp "$source/data/logs/jump.csv" "$here/my.log"
cd "$here" || exit 1
export PATH="$here/bin:$PATH"
faults=0

fault() {
  echo "README.md: $*"
  faults=$((faults + 1))
}

run() { # COMMAND ...: as printed
  "$@" > out.txt 2>&1 || { fault "$*: exit $?"; tail -n 5 out.txt; }
}

block() { awk -v begin="\`\`\`$1" '$0 == begin { inside = 1; next } /^```/ { inside = 0 } inside' "$source/README.md"; }

scripts=0
while read -r script _; do
  [ -x "$source/$script" ] || fault "there is no $script"
  scripts=$((scripts + 1))
done < <(block sh)
[ "$scripts" -ge 2 ] || fault "only $scripts commands to begin with"

examples=0
while IFS= read -r example; do
  # shellcheck disable=SC2086
  run $example
  examples=$((examples + 1))
done < <(grep -E '^\| `' "$source/README.md" | grep -oE '`goingrate [^`]+` \|$' | tr -d '`' | sed 's/ |$//')
[ "$examples" -ge 9 ] || fault "only $examples examples in the table of commands"

block toml > all.toml
[ -s all.toml ] || fault "no scenario"
run goingrate simulate all.toml --set run.periods=300 -o all.csv

awk '/^# goingrate par/ { inside = 1 } /^```/ { inside = 0 } inside' "$source/README.md" > clock.par
[ -s clock.par ] || fault "no file of parameters"
run goingrate fit my.log --from clock.par

[ "$faults" -eq 0 ] || exit 1
echo "$examples examples, the scenario and the parameters of the README run as printed."
