#!/usr/bin/env bash
# A batch in shares gives the same bytes as one process, even if a share is killed and repeated: under Slurm, GNU
# parallel and Snakemake, if they are installed, and by plain processes.
# run.sh GOINGRATE SOURCE FOLDER [SHARES]; FOLDER is emptied first. Uses only what is installed; with
# GOINGRATE_CLUSTER=all a program that is missing is a fault.
set -uo pipefail
export GOINGRATE
GOINGRATE=$(realpath "$1")
source=$(realpath "$2")
folder=$3 shares=${4:-8}
rm -rf "$folder"
mkdir -p "$folder/bin"
folder=$(realpath "$folder")
ln -s "$GOINGRATE" "$folder/bin/goingrate"
export PATH="$folder/bin:$PATH"
. "$source/tests/cluster/slurm.sh"
cd "$folder" || exit 1
faults=0

fault() {
  echo "$*"
  faults=$((faults + 1))
}

here() { # NAME PROGRAM...: whether all are there
  local name=$1 program
  shift
  for program in "$@"; do
    command -v "$program" > /dev/null || [ -x "/usr/sbin/$program" ] && continue
    if [ "${GOINGRATE_CLUSTER:-}" = all ]; then fault "$name: there is no $program"; else echo "$name: not here, left out"; fi
    return 1
  done
}

same() { # WHAT FILE
  if cmp -s one.jsonl "$2"; then echo "$1: the bytes of one process"; else fault "$1: other bytes than one process"; fi
}

cp "$source/data/scenarios/jump.toml" jump.toml
# 20 clocks a share: it takes more than a second, so that one can be killed at work.
words=(--scenario jump.toml --set run.periods=2000 --realisations 160 --seed 1000
  fit --fix T0=2 --event 150:mu)
goingrate batch "${words[@]}" -o one.jsonl || fault "one process failed"

finished() { # JOB: waits until Slurm has no more of it, three minutes at most
  local i
  for ((i = 0; i < 360; ++i)); do
    [ -z "$(squeue -h -j "$1" -o %i 2> /dev/null)" ] && return 0
    sleep 0.5
  done
  fault "Slurm: job $1 does not end"
  squeue
  return 1
}

under_slurm() {
  local jobs array merge i killed=
  slurm_up slurm || { fault "Slurm did not start"; return; }
  jobs=$("$source/apps/slurm/goingrate.sbatch" "$shares" out "${words[@]}")
  echo "Slurm: $jobs"
  array=$(sed -E 's/.*shares: job ([0-9]+).*/\1/' <<< "$jobs")
  merge=$(sed -E 's/.*merge: job ([0-9]+).*/\1/' <<< "$jobs")
  # The first share that is at work and has lines loses its processes as by a node that dies, and its task
  # with them.
  for ((i = 0; i < 2400; ++i)); do
    for part in out/share-*.part; do
      [ -e "$part" ] && [ "$(wc -l < "$part")" -ge 3 ] || continue
      killed=$(sed -E 's/.*share-([0-9]+)-of-.*/\1/' <<< "$part")
      scancel --signal=KILL --full "${array}_$killed" && break 2
    done
    sleep 0.05
  done
  [ -n "$killed" ] || fault "Slurm: no share was seen at work"
  finished "$array"
  finished "$merge"
  [ -e "out/share-$killed-of-$shares.jsonl" ] && fault "Slurm: share $killed was not killed"
  [ -e out/batch.jsonl ] && fault "Slurm: a merge without share $killed"
  [ "$(ls out/share-*.jsonl | wc -l)" -eq $((shares - 1)) ] || fault "Slurm: more than one share is missing"
  jobs=$("$source/apps/slurm/goingrate.sbatch" "$shares" out --only "$killed" "${words[@]}")
  echo "Slurm: share $killed was killed; again: $jobs"
  finished "$(sed -E 's/.*merge: job ([0-9]+).*/\1/' <<< "$jobs")"
  grep -h 'were done before' out/slurm-*.log || fault "Slurm: the share was not taken up where it was"
  same "Slurm, $shares shares" out/batch.jsonl
  slurm_down
}

if here Slurm slurmctld slurmd sbatch; then
  trap slurm_down EXIT
  under_slurm
fi

share() { goingrate batch "${words[@]}" --share "$1/$shares" --resume -o "plain-$1.jsonl" 2> /dev/null; }
for ((k = 1; k <= shares; ++k)); do share "$k" || fault "share $k failed"; done
goingrate batch merge plain-*.jsonl -o plain.jsonl && same "Plain processes" plain.jsonl

# The commands that the guide prints, as printed.
block() { awk -v begin="\`\`\`$1" '$0 == begin { inside = 1; next } /^```/ { inside = 0 } inside' "$source/data/guide/batch.md"; }
if here "GNU parallel" parallel; then
  block parallel > parallel.sh
  bash -e parallel.sh > parallel.log 2>&1 && same "GNU parallel" parallel/jump.jsonl \
    || { fault "GNU parallel failed"; tail -n 5 parallel.log; }
fi
if here Snakemake snakemake; then
  block snakemake > Snakefile
  snakemake --cores 2 > snakemake.log 2>&1 && same Snakemake snakemake/jump.jsonl \
    || { fault "Snakemake failed"; tail -n 5 snakemake.log; }
fi

[ "$faults" -eq 0 ] || exit 1
rm -rf "$folder"
