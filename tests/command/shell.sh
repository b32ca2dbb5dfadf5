#!/usr/bin/env bash
# Habits of the shell: bash completes commands, options and their values; the manual page has every command,
# option and format; errors begin with goingrate:, in colour on a terminal alone.
# shell.sh GOINGRATE SOURCE
set -uo pipefail
goingrate=$(realpath "$1") source=$(realpath "$2")
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
mkdir "$here/bin"
ln -s "$goingrate" "$here/bin/goingrate"
cp "$source/data/logs/jump.csv" "$here/my.log"
cd "$here" || exit 1
export PATH="$here/bin:$PATH" LC_ALL=C.UTF-8
faults=0

fault() {
  echo "FAULT: $*"
  faults=$((faults + 1))
}

# As bash calls it: the line up to the cursor, and the words it makes of it.
# shellcheck source=/dev/null
. "$source/apps/goingrate.bash"
completed() { # LINE
  COMP_LINE=$1 COMP_POINT=${#1}
  COMPREPLY=()
  _goingrate
  echo "${COMPREPLY[*]}"
}
expect() { # LINE WORDS
  local found
  found=$(completed "$1")
  [ "$found" = "$2" ] || fault "'$1' is completed by '$found', expected '$2'"
}
expect 'goingrate re' 'report'
expect 'goingrate rate --format t' 'timestamps ticc ticc-interval table ticktock'
expect 'goingrate rate my.log --format=per' 'periods'
expect 'goingrate fit my.log --noise ' 'jitter drive both slow auto'
expect 'goingrate fit my.log --model=m' 'map'
expect 'goingrate fit my.log --fix ep' 'epsilon='
expect 'goingrate fit my.log --fix T0=2 --prior la' 'lambda0='
expect 'goingrate fit my.log --free drift,te' 'drift,temperature'
expect 'goingrate rate my.log --column amp' 'amplitude='
expect 'goingrate stability my.log --kind hd' 'hdev'
expect 'goingrate stability my.log --taus d' 'decade'
expect 'goingrate map --solve amplitude=0.05 ra' 'rate= rate_excess='
expect 'goingrate help ex' 'exit-codes'
expect 'goingrate rate my.log --quie' '--quiet'
expect 'goingrate batch s' 'stability summary'
expect 'goingrate batch --re' '--realisations --resume'
expect 'goingrate batch fit logs/*.csv --free drift,te' 'drift,temperature'
expect 'goingrate batch stability my.log --kind hd' 'hdev'
expect 'goingrate batch rate my.log --re' '--rest-angle --realisations --resume'
expect 'goingrate batch --scenario my.toml --realisations 9 -- fit --noise=d' 'drive'
expect 'goingrate batch summary my.jsonl --j' '--json'
expect 'goingrate batch fit my' ''
expect 'goingrate rate my' ''
expect 'goingrate rate --nominal-period ' ''
for command in $(completed 'goingrate '); do
  goingrate "$command" --help > help.txt || fault "completion offers $command, which is no command"
  for option in $(completed "goingrate $command --"); do
    grep -qF -- "$option" help.txt || [ "$option" = --quiet ] || [ "$option" = --version ] \
      || fault "completion offers $command $option, which --help does not know"
  done
done
[ "$(completed 'goingrate ' | wc -w)" -ge 10 ] || fault "completion offers too few commands"

goingrate --man > goingrate.1 || fault "no manual page"
for command in $(completed 'goingrate '); do
  for option in $(goingrate "$command" --help | grep -oE '^ +(-[a-z],)?--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+'); do
    [ "$option" = --help ] || grep -qF -- "${option//-/\\-}" goingrate.1 || fault "the manual page lacks $command $option"
  done
done
for word in $(completed 'goingrate rate --format '); do
  grep -qF -- "${word//-/\\-}" goingrate.1 || fault "the manual page lacks the format $word"
  goingrate help formats | grep -q "^  $word " || fault "help formats lacks $word"
done
if command -v groff > /dev/null; then
  groff -man -Tutf8 -ww goingrate.1 > man.txt 2> complaints.txt
  [ ! -s complaints.txt ] || { fault "groff complains of the manual page"; head -n 5 complaints.txt; }
fi

error() { # ARGUMENTS...: the last line of standard error
  goingrate "$@" 2>&1 > /dev/null | tail -n 1
}
while IFS='|' read -r arguments expected; do
  # shellcheck disable=SC2086
  found=$(error $arguments)
  [[ $found == "goingrate: "* && $found == *"$expected"* ]] || fault "goingrate $arguments: $found"
done << 'ERRORS'
fit my.log --fix t0=2|--fix = 't0': must be
fit my.log --fix t0=2|(did you mean T0?)
fit my.log --free temperature|this log has no temperature column; leave --free temperature out
fit my.log --free density|this log has no temperature column; leave --free density out
spectrum my.log --against pressure --coherence c.csv|this log has no pressure column
spectrum my.log --against amplitude --coherence c.csv|this log has no amplitude column
rate my.log --format perods|(did you mean periods?)
rate my.log --column tmie=2|(did you mean time?)
fit my.log --event 150:my|must be a change of
help format|(did you mean formats?)
reprot my.log|(did you mean report?)
rate none.log|found no file of that name
rate|goingrate rate --help lists the options
ERRORS

if command -v script > /dev/null; then
  on_terminal() { script -qec "$*" /dev/null < /dev/null | tr -d '\r'; }
  shown=$(TERM=xterm on_terminal goingrate rate none.log)
  [[ $shown == *$'\x1b[1;31mgoingrate:'* ]] || fault "no colour on a terminal"
  shown=$(TERM=xterm NO_COLOR=1 on_terminal goingrate rate none.log)
  [[ $shown == "goingrate: "* ]] || fault "NO_COLOR is not respected: $shown"
  shown=$(TERM=dumb on_terminal goingrate rate none.log)
  [[ $shown == "goingrate: "* ]] || fault "colour on a dumb terminal: $shown"
  shown=$(TERM=xterm on_terminal goingrate simulate "$source/data/scenarios/jump.toml" --set run.periods=20000000 -o /dev/null)
  [[ $shown == *'simulating ['* ]] || fault "no progress of a long simulation"
fi
[[ $(error rate none.log) != *$'\x1b'* ]] || fault "colour in a pipe"

[ "$faults" -eq 0 ] || exit 1
echo "Completion, manual page and errors are as documented."
