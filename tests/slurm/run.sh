#!/usr/bin/env bash
# Runs one sweep alone and through a Slurm of one node, started here without systemd, and compares the cells:
#   run.sh NEARFIELD SCENE WORK
# Exit code 77 where Slurm is not installed or cannot be started here.
set -euo pipefail
nearfield=$(readlink -f "$1") scene=$(readlink -f "$2") work=$3

skip() {
  printf '%s\n' "SKIPPED: $*" >&2
  exit 77
}
for program in munged slurmctld slurmd sbatch squeue; do
  command -v "$program" >/dev/null || skip "$program is not installed; ./test.sh --all installs slurm-wlm and munge"
done
[ "$(id -u)" -eq 0 ] || skip "Slurm's daemons are started as root here"

rm -rf "$work"
mkdir -p "$work"/state "$work"/spool
work=$(readlink -f "$work")
pids=()
stop() {
  local pid
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
}
trap stop EXIT

# The key and the socket of munge are our own, so that one that runs already is left alone.
dd if=/dev/urandom of="$work/munge.key" bs=128 count=1 status=none
chown munge "$work/munge.key" && chmod 400 "$work/munge.key"
munge_folder=$(mktemp -d /tmp/nf_munge.XXXXXX)
chown munge "$munge_folder" && chmod 755 "$munge_folder"
mv "$work/munge.key" "$munge_folder/"
setpriv --reuid=munge --regid=munge --clear-groups munged --foreground --key-file="$munge_folder/munge.key" \
  --socket="$munge_folder/socket" --pid-file="$munge_folder/pid" --log-file="$munge_folder/log" \
  --seed-file="$munge_folder/seed" >"$work/munged.log" 2>&1 &
pids+=($!)

port=$((20000 + $$ % 20000))
cat >"$work/slurm.conf" <<CONF
ClusterName=nearfield
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$munge_folder/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MpiDefault=none
ReturnToService=2
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
for _ in $(seq 50); do [ -S "$munge_folder/socket" ] && break || sleep 0.1; done
[ -S "$munge_folder/socket" ] || skip "munged does not start: $(tail -1 "$work/munged.log")"
slurmctld -D >"$work/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -N "$(hostname)" >"$work/slurmd.out" 2>&1 &
pids+=($!)
up=
for _ in $(seq 100); do
  if [ "$(sinfo --noheader --format=%T 2>/dev/null)" = idle ]; then up=1 && break; fi
  sleep 0.2
done
[ "$up" ] || skip "Slurm's node does not come up: $(tail -2 "$work/slurmd.log" "$work/slurmctld.log" 2>/dev/null | tr '\n' ' ')"

cat >"$work/spec.json" <<SPEC
{"schema": "nearfield.sweep/1", "scene": "$scene", "size": [32, 18], "reference": {"spp": 4}, "repeats": 1, "warmup": 1,
 "frames": 2, "group": 2,
 "runs": [{"technique": "none"}, {"technique": "vbgi", "permute": {"gi.slices": [1, 2], "gi.steps": [2, 4, 6]}}]}
SPEC
"$nearfield" sweep "$work/spec.json" -o "$work/alone" --quiet >/dev/null
"$nearfield" sweep "$work/spec.json" --emit slurm "$work/jobs" --quiet >/dev/null
"$work/jobs/submit.sh"
for _ in $(seq 300); do
  [ -n "$(squeue --noheader)" ] || break
  sleep 0.2
done
"$nearfield" sweep --merge "$work/jobs" --quiet >/dev/null
ids() { grep -o '"id":"[^"]*"' "$1" | sort; }
diff <(ids "$work/alone/cells.jsonl") <(ids "$work/jobs/cells.jsonl")
rm -rf "$munge_folder"
printf '%s\n' "ok: $(ids "$work/jobs/cells.jsonl" | wc -l) cells, the same through Slurm, in $(find "$work/jobs/parts" -name '*.jsonl' | wc -l) tasks"
