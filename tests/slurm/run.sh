#!/bin/sh
# Batches on a real Slurm: sh tests/slurm/run.sh [RAYCONE]
# Starts a Slurm of its own on this machine (one controller, one node; as root, since Slurm wants that), submits
# app/slurm/raycone-array.sbatch over 30 meshes, kills one task half-way, requeues it, and compares with a single run;
# then an array with a broken mesh and a job behind it, and the same shards by GNU parallel.
# Packages: slurm-wlm munge parallel.
set -eu
cd "$(dirname "$0")/../.."
root=$PWD
raycone=$(realpath "${1:-build/dev/app/raycone}")
work=$(mktemp -d)
pids=
options='--resolution 32 --progress never --quiet'

stop() {
  for pid in $pids; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap stop EXIT
trap 'exit 1' INT TERM

fail() {
  echo "slurm: $1" >&2
  exit 1
}

# wait_for SECONDS COMMAND...: until the command succeeds.
wait_for() {
  patience=$1
  shift
  while ! "$@" >/dev/null 2>&1; do
    patience=$((patience - 1))
    [ "$patience" -gt 0 ] || fail "gave up waiting for: $*"
    sleep 1
  done
}

for program in slurmctld slurmd munged sbatch parallel; do
  command -v "$program" >/dev/null || fail "$program is missing, install slurm-wlm munge parallel"
done
[ "$(id -u)" -eq 0 ] || fail 'Slurm must be started by root'

# --- A Slurm of our own

mkdir "$work/munge" "$work/state" "$work/spool"
chmod 755 "$work"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 2>/dev/null
chmod 400 "$work/munge/key"
munged --force --foreground --key-file "$work/munge/key" --socket "$work/munge/socket" --pid-file "$work/munge/pid" \
  --seed-file "$work/munge/seed" --log-file "$work/munge/log" &
pids="$pids $!"
host=$(hostname -s)
cat >"$work/slurm.conf" <<END
ClusterName=raycone
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
MinJobAge=600
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF="$work/slurm.conf"
wait_for 10 test -S "$work/munge/socket"
slurmctld -D >/dev/null 2>&1 &
pids="$pids $!"
slurmd -D >/dev/null 2>&1 &
pids="$pids $!"
wait_for 60 sh -c 'sinfo --noheader --format %T | grep -qE "idle|mix|alloc"'

# --- Thirty meshes, and what a single run makes of them

python3 - "$work/meshes" <<'END'
import os, random, sys
os.makedirs(sys.argv[1])
random.seed(1)
for i in range(30):
    with open(f"{sys.argv[1]}/{i}.obj", "w") as f:
        n = 100 + 40 * i
        for _ in range(3 * n): print("v", random.random(), random.random(), random.random(), file=f)
        for t in range(n): print("f", 3 * t + 1, 3 * t + 2, 3 * t + 3, file=f)
END
"$raycone" batch "$work/meshes" --out-dir "$work/single" $options

# compare DIRECTORY: its outputs, and its rows but for times and memory, are those of the single run.
compare() {
  diff -r --exclude='results*' --exclude='batch-state*' --exclude='report.html' "$work/single" "$1" ||
    fail "outputs in $1 differ"
  for directory in "$work/single" "$1"; do
    cut -d, -f1-8,14- "$directory/results.csv" >"$directory.rows"
  done
  cmp "$work/single.rows" "$1.rows" || fail "results in $1 differ"
  find "$1" -name '.raycone-*' | grep . && fail "temporary files are left in $1" || true
}

# --- The array, one of its tasks killed and requeued

array=1-5
job=$(RAYCONE=$raycone sbatch --parsable --array="$array" --cpus-per-task=1 --mem-per-cpu=0 --output="$work/task-%a.log" \
  "$root/app/slurm/raycone-array.sbatch" "$work/meshes" "$work/array" $options)
wait_for 60 test -s "$work/array/results-2-of-5.csv"
scontrol requeue "${job}_2"
wait_for 300 sh -c "! squeue --noheader --array --job $job | grep -q ."
restarts=$(scontrol show job "${job}_2" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p' | head -n 1)
[ "${restarts:-0}" -ge 1 ] || fail 'the task was done before it could be killed'
for task in 1 2 3 4 5; do [ -s "$work/array/results-$task-of-5.csv" ] || fail "task $task wrote no results"; done
"$raycone" batch "$work/meshes" --out-dir "$work/array" --dry-run $options | grep . && fail 'tasks left meshes undone'
"$raycone" batch "$work/meshes" --out-dir "$work/array" $options
compare "$work/array"

# --- An irregular array is refused

job=$(RAYCONE=$raycone sbatch --parsable --array=1,2,5 --cpus-per-task=1 --mem-per-cpu=0 --output="$work/gap-%a.log" \
  "$root/app/slurm/raycone-array.sbatch" "$work/meshes" "$work/gaps" $options)
wait_for 120 sh -c "! squeue --noheader --array --job $job | grep -q ."
grep -q 'have gaps' "$work/gap-1.log" || fail 'an array with gaps was not refused'

# --- A broken mesh: its task fails, and the job behind the array never starts; with --exit-zero it does

echo 'no mesh' >"$work/meshes/broken.obj"
# chain NAME OPTIONS: an array of three tasks into a directory of that name, and the job behind it of docs/cluster.md.
# Sets `behind`.
chain() {
  array=$(RAYCONE=$raycone sbatch --parsable --array=1-3 --cpus-per-task=1 --mem-per-cpu=0 \
    --output="$work/$1-%a.log" "$root/app/slurm/raycone-array.sbatch" "$work/meshes" "$work/$1" $options $2)
  behind=$(sbatch --parsable --dependency="afterok:$array" --mem-per-cpu=0 --output="$work/$1.log" \
    --wrap "'$raycone' batch '$work/meshes' --out-dir '$work/$1' $options $2 && '$raycone' report '$work/$1'")
}
chain strict ''
wait_for 120 sh -c "scontrol show job $behind | grep -q DependencyNeverSatisfied"
[ ! -e "$work/strict/report.html" ] || fail 'the job behind an array with a failed task ran'
scancel "$behind"
chain zero --exit-zero
wait_for 120 sh -c "! squeue --noheader --job $behind | grep -q ."
[ -s "$work/zero/report.html" ] || fail 'the job behind the array did not run'
[ "$(grep -c '^broken.obj,invalid,2,' "$work/zero/results.csv")" -eq 1 ] || fail 'the broken mesh has no row'
[ "$(grep -c ',ok,0,' "$work/zero/results.csv")" -eq 30 ] || fail 'the other meshes are not ok'
rm "$work/meshes/broken.obj"

# --- The same shards by GNU parallel

parallel --will-cite -j 2 "$raycone" batch "$work/meshes" --out-dir "$work/parallel" --threads 1 --shard '{}/5' $options \
  ::: 1 2 3 4 5
"$raycone" batch "$work/meshes" --out-dir "$work/parallel" $options
compare "$work/parallel"
echo 'slurm: a requeued task, gaps, broken meshes with and without --exit-zero, and GNU parallel: all as they should be'
