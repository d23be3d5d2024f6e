#!/usr/bin/env bash
# aerosol submit --slurm on a real Slurm of one node, started here and stopped at the end: an array job whose merge has the
# bits of one render. Left out, with a message, where Slurm is not installed or does not start; with
# AEROSOL_REQUIRE_SLURM=1 that is a failure.
source "${BASH_SOURCE[0]%/*}/library.sh"

leaveOut() {
  [ "${AEROSOL_REQUIRE_SLURM:-0}" != 1 ] || fail "$1"
  echo "LEFT OUT: $1"
  exit 0
}

for program in slurmctld slurmd sbatch squeue munged; do
  PATH=$PATH:/usr/sbin command -v $program >/dev/null || leaveOut "$program is not installed"
done
[ "$(id -u)" = 0 ] || leaveOut "Slurm's daemons need root to start jobs"
PATH=$PATH:/usr/sbin

daemons=()
stop() {
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
  for daemon in "${daemons[@]}"; do wait "$daemon" 2>/dev/null || true; done
  chmod -R u+w "$work"
  rm -rf "$work"
}
trap stop EXIT

etc=$work/etc
mkdir -p "$etc" "$work/state" "$work/spool"
host=$(hostname -s)
chmod 755 "$work" "$etc"
dd if=/dev/urandom of="$etc/munge.key" bs=1 count=1024 2>/dev/null
chmod 400 "$etc/munge.key"
socket=$work/munge/socket
mkdir -p "$work/munge"
chmod 755 "$work/munge"
munged --foreground --force --key-file="$etc/munge.key" --socket="$socket" --pid-file="$work/munge/pid" \
  --log-file="$work/munge/log" --seed-file="$work/munge/seed" >"$work/munge.out" 2>&1 &
daemons+=($!)

# Ports that nobody listens on, as far as that can be known.
port=$((20000 + RANDOM % 20000))
cat >"$etc/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$etc/slurm.conf
for _ in $(seq 50); do
  [ ! -S "$socket" ] || break
  sleep 0.1
done
[ -S "$socket" ] || leaveOut "munged did not start: $(tail -1 "$work/munge.out")"
slurmctld -D >"$work/slurmctld.log" 2>&1 &
daemons+=($!)
slurmd -D -N "$host" >"$work/slurmd.log" 2>&1 &
daemons+=($!)
isIdle=
for _ in $(seq 100); do
  if sinfo -h -o %t 2>/dev/null | grep -q idle; then
    isIdle=1
    break
  fi
  sleep 0.2
done
[ -n "$isIdle" ] || leaveOut "Slurm did not start: $(tail -2 "$work/slurmctld.log" "$work/slurmd.log" | tr '\n' ' ')"

expect 0 submit "$input/fog.xml" -o whole.exr --spp 9 --tasks 3 --folder "$work/job" --slurm
said out "render job "
said out "merge job "
for _ in $(seq 300); do
  [ -n "$(squeue -h)" ] || break
  sleep 0.2
done
[ -s whole.exr ] || fail "no image was merged: $(cat job/logs/*)"
expect 0 render "$input/fog.xml" -o one.exr --spp 9 --isa avx2 --quiet
# Whatever else the two files say, the parts of a job made of either merge to the same sums.
expect 0 render "$input/fog.xml" -o sums.exr --spp 9 --isa avx2 --quiet --keep-sums
expect 0 merge sums.exr -o a.png
expect 0 merge job/parts/*.exr -o b.png
pixels() {
  # The compressed pixels of a PNG: its IDAT chunks come last but for the end.
  grep -obUa IDAT "$1" | head -1 | cut -d: -f1 | xargs -I{} tail -c +{} "$1" | cksum
}
[ "$(pixels a.png)" = "$(pixels b.png)" ] || fail "the image of the job is another one"

# A task that is lost is noticed by the merge.
rm whole.exr job/parts/*
sed -i 's/^1) exec/1) exit 1; exec/' job/tasks.sh
id=$(sbatch --parsable job/render.sbatch)
sbatch --parsable --dependency=afterany:"$id" job/merge.sbatch >/dev/null
for _ in $(seq 300); do
  [ -n "$(squeue -h)" ] || break
  sleep 0.2
done
[ ! -e whole.exr ] || fail "an image was merged of which a task is lost"
grep -q "parts/3-6.exr: error" job/logs/merge-0.txt || fail "the merge said: $(cat job/logs/merge-0.txt)"
echo "OK"
