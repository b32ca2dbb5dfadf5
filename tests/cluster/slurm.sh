# Sourced: a Slurm of one node, this machine, that lives in a folder and needs neither root's files nor munge
# nor systemd. `slurm_up FOLDER` starts it, `slurm_down` ends it.

slurm_up() { # FOLDER
  slurm_folder=$(realpath "$1")
  local host cpus memory user
  host=$(hostname -s) cpus=$(nproc) user=$(id -un)
  memory=$(awk '/^MemTotal/ { print int($2 / 1024) }' /proc/meminfo)
  mkdir -p "$slurm_folder"/{state,spool,log}
  # Free ports: the kernel's choice changes from run to run.
  local base=$((20000 + $$ % 20000))
  cat > "$slurm_folder/slurm.conf" <<END
ClusterName=goingrate
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$base
SlurmdPort=$((base + 1))
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
StateSaveLocation=$slurm_folder/state
SlurmdSpoolDir=$slurm_folder/spool
SlurmctldPidFile=$slurm_folder/slurmctld.pid
SlurmdPidFile=$slurm_folder/slurmd.pid
SlurmctldLogFile=$slurm_folder/log/slurmctld.log
SlurmdLogFile=$slurm_folder/log/slurmd.log
ReturnToService=2
InactiveLimit=0
KillWait=1
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
  export SLURM_CONF=$slurm_folder/slurm.conf
  export PATH=$PATH:/usr/sbin
  slurmctld -D -i > "$slurm_folder/log/slurmctld.out" 2>&1 &
  slurm_pids=($!)
  slurmd -D > "$slurm_folder/log/slurmd.out" 2>&1 &
  slurm_pids+=($!)
  local try
  for try in $(seq 60); do
    [ "$(sinfo -h -o %t 2> /dev/null)" = idle ] && return 0
    sleep 0.5
  done
  echo "Slurm did not come up:" >&2
  tail -n 20 "$slurm_folder"/log/* >&2
  return 1
}

slurm_down() {
  scancel --user "$(id -un)" 2> /dev/null || true
  local pid
  for pid in "${slurm_pids[@]}"; do kill "$pid" 2> /dev/null || true; done
  for pid in "${slurm_pids[@]}"; do wait "$pid" 2> /dev/null || true; done
}
