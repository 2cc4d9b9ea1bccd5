#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_cluster.sh slurm|mpi PROGRAM FOLDER   a study on a real slurmctld and slurmd of this machine, or under mpirun: it
# comes to the table that this machine alone comes to. Exit status 77 where the packages are missing
# (tools/install-packages --test).
set -euo pipefail
kind=$1 program=$2 folder=$3
PATH=$PATH:/usr/sbin

rm -rf "$folder"
mkdir -p "$folder"
cat >"$folder/plan.json" <<'JSON'
{"format": "trocar-study-plan", "version": 1, "name": "cluster", "task": "peg_transfer", "seeds": [1, 6],
 "parameters": {"gravity": [5, 9.81]}, "most_seconds": 0.5}
JSON
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1

# the table of this machine alone
"$program" study "$folder/plan.json" --jobs 2 -o "$folder/local"

if [ "$kind" = mpi ]; then
  command -v mpirun >/dev/null || exit 77
  "$program" study "$folder/plan.json" --backend mpi --jobs 3 -o "$folder/mpi"
  cmp "$folder/local/runs.csv" "$folder/mpi/runs.csv"
  echo "12 runs under mpirun: the same table"
  exit 0
fi

for tool in slurmctld slurmd sbatch; do command -v "$tool" >/dev/null || exit 77; done
user=$(id -un) host=$(hostname -s) slurm=$folder/slurm
mkdir -p "$slurm/state" "$slurm/spool"
# ports that nobody listens on: another test may have a cluster of its own
port=$((20000 + $$ % 20000))
cat >"$slurm/slurm.conf" <<CONF
ClusterName=trocar
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/linear
MpiDefault=none
ReturnToService=2
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4
CONF
export SLURM_CONF=$slurm/slurm.conf

pids=()
end() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
}
trap end EXIT

# without a cluster: its code
if "$program" study "$folder/plan.json" --backend slurm --jobs 2 -o "$folder/away" 2>"$folder/away.txt"; then
  echo "a study ran on a cluster that is not there" >&2
  exit 1
fi
grep -q E-STU-003 "$folder/away.txt"

slurmctld -D -f "$SLURM_CONF" >"$slurm/ctld.out" 2>&1 &
pids+=($!)
slurmd -D -f "$SLURM_CONF" -N "$host" >"$slurm/d.out" 2>&1 &
pids+=($!)
for _ in $(seq 60); do
  sinfo -h -o %T 2>/dev/null | grep -qE '^idle' && break
  sleep 0.5
done
if ! sinfo -h -o %T | grep -qE '^idle'; then
  tail -n 20 "$slurm"/*.log "$slurm"/*.out >&2
  exit 1
fi
"$program" study "$folder/plan.json" --backend slurm --jobs 3 -o "$folder/array"
ls "$folder"/array/logs/slurm-*.log >/dev/null
cmp "$folder/local/runs.csv" "$folder/array/runs.csv"
echo "12 runs in a Slurm array of 3: the same table"
