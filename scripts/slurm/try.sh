#!/usr/bin/env bash
# A sweep on a real Slurm, on one machine: two nodes, one of which is killed while it computes, and a job that somebody
# cancels. Shows that every point is there in the end and that the results are those of a run without Slurm.
#
#   sudo scripts/slurm/try.sh
#   scripts/slurm/try.sh --stand-in      # without Slurm: scripts/slurm/stand-in in its place
#
# Each step waits for the state that the next one needs, however long that takes; it gives up where nothing has changed for
# five minutes. Needs Debian or Ubuntu. Installs slurmctld, slurmd and munge from there if they are missing; configuration,
# state and logs lie in a folder of their own, so a Slurm that the machine already has is not touched. AURT names the program
# to try; without it, it is built.
set -euo pipefail
cd "$(dirname "$0")/../.."

stand_in="${1:-}"
[[ -z "$stand_in" || "$stand_in" == --stand-in ]] || { echo "usage: $0 [--stand-in]" >&2; exit 2; }
if [[ -z "$stand_in" ]] && ((EUID != 0)); then
    echo "Slurm's daemons want to be started by root; $0 --stand-in does without Slurm" >&2
    exit 2
fi
if [[ -z "${AURT:-}" ]]; then
    cargo build --quiet --release
    AURT="$(cargo metadata --format-version 1 --no-deps | sed -E 's/.*"target_directory":"([^"]*)".*/\1/')/release/aurt"
fi
AURT="$(realpath "$AURT")"
for program in munged slurmctld slurmd sbatch; do
    [[ -n "$stand_in" ]] || command -v "$program" >/dev/null ||
        apt-get install -y --no-install-recommends slurmctld slurmd slurm-client munge >/dev/null
done

scratch="$(mktemp -d)"
chmod 755 "$scratch" # munge wants to know that nobody but root can write above its socket
pid_of() { cat "$scratch/$1.pid" 2>/dev/null || true; }
clean_up() {
    for daemon in node1 node2 slurmctld munged; do
        pid="$(pid_of "$daemon")"
        [[ -n "$pid" ]] && kill "$pid" 2>/dev/null || continue
        # They write a last time when they end.
        kill -CONT "$pid" 2>/dev/null || true
        tail --pid="$pid" --follow /dev/null
    done
    rm -rf "$scratch"
}
trap clean_up EXIT

# Starts a controller and two nodes.
start_slurm() {
    mkdir "$scratch/munge" "$scratch/state"
    head -c 1024 /dev/urandom >"$scratch/munge/key"
    chmod 600 "$scratch/munge/key"
    cat >"$scratch/slurm.conf" <<CONF
ClusterName=try
SlurmctldHost=localhost
SlurmctldPort=16817
SlurmUser=root
# A lost job may start again after the life of its credential.
AuthInfo=socket=$scratch/munge/socket,cred_expire=5
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool-%n
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/%n.pid
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/%n.log
# No control groups: this also works in a container.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
# A node that does not answer for so many seconds is down, and its jobs start again elsewhere.
SlurmdTimeout=10
# What has ended is remembered until the end.
MinJobAge=36000
JobRequeue=1
NodeName=node1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=16818 CPUs=1 State=UNKNOWN
NodeName=node2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=16819 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
    export SLURM_CONF="$scratch/slurm.conf"
    say "$(slurmctld -V): one controller, two nodes"
    munged --socket="$scratch/munge/socket" --key-file="$scratch/munge/key" --pid-file="$scratch/munged.pid" \
        --log-file="$scratch/munge/log" --seed-file="$scratch/munge/seed"
    slurmctld
    slurmd -N node1
    slurmd -N node2
}
start_stand_in() {
    export SLURM_STAND_IN="$scratch"
    mkdir "$scratch/bin" "$scratch/queue" "$scratch/running" "$scratch/restarts"
    for command in sbatch squeue scancel sinfo scontrol slurmctld node; do
        ln -s "$PWD/scripts/slurm/stand-in" "$scratch/bin/$command"
    done
    export PATH="$scratch/bin:$PATH"
    say "a stand-in for Slurm: one controller, two nodes"
    for daemon in slurmctld "node node1" "node node2"; do
        # shellcheck disable=SC2086 # a command and its argument
        setsid $daemon >>"$scratch/daemons.log" 2>&1 &
        disown
    done
}

say() { printf '\n# %s\n' "$1"; }
show() { sed "s|$scratch|.|g; s|$AURT|aurt|g"; }
aurt() { "$AURT" "$@" 2>&1 | show; return "${PIPESTATUS[0]}"; }
tasks() { squeue --noheader --array --format='%K %T %N %r' | sort -n; }
has_result() {
    local key
    key="$(grep -o '"key": *"[0-9a-f]*"' sweep/sweep.json | sed -n "${1}s/.*\"\([0-9a-f]*\)\"/\1/p")"
    [[ -e "sweep/results/$key.json" ]]
}
seen() { tasks; sinfo --noheader --Node --format='%N %t'; find sweep/results -name '*.json' 2>/dev/null | wc -l; }
# Waits for what the command says, as long as anything changes.
wait_for() {
    local now before="" still="$SECONDS"
    until "$@"; do
        now="$(seen 2>/dev/null)" || true
        [[ "$now" == "$before" ]] || still="$SECONDS"
        before="$now"
        ((SECONDS - still < 300)) ||
            { echo "nothing has changed for 300 s: $*" >&2; seen >&2; tail -n 20 "$scratch"/*.log >&2; exit 1; }
        sleep 0.2
    done
}

if [[ -n "$stand_in" ]]; then start_stand_in; else start_slurm; fi
nodes_are() { [[ "$(sinfo --noheader --Node --format='%N %t' | tr '\n' ' ')" == "$1" ]]; }
wait_for nodes_are "node1 idle node2 idle "
sinfo --Node --format='%N %t'

cd "$scratch"
"$AURT" demo --out demo --quiet >/dev/null
sed '/^\[\[joint_dynamics.override\]\]/,/^\[recordings\]/{/^\[recordings\]/!d}' demo/experiment.toml >demo/sweep.toml
for coulomb in none absolute; do
    for hysteresis in sign dahl lugre; do
        for powers in "1" "1, 2"; do
            cat <<VARIANT
[[sweep.variant]]
name = "$coulomb, $hysteresis, {$powers}"
set = { "joint_dynamics.coulomb.model" = "$coulomb", "joint_dynamics.hysteresis.model" = "$hysteresis", "joint_dynamics.viscous.powers" = [$powers] }
VARIANT
        done
    done
done >>demo/sweep.toml

# Nothing starts before the job is released: what waits can be cancelled while it waits.
submit() {
    say "aurt sweep run demo/sweep.toml --out sweep --engine slurm --slurm-arg=--hold"
    aurt sweep run demo/sweep.toml --out sweep --engine slurm --slurm-arg=--hold
    array="$(squeue --noheader --format=%F | head -n 1)"
    say "somebody cancels point 12, which waits: Slurm will not start it again"
    scancel "${array}_12"
    scontrol release "$array"
}

# The processes of a node's jobs and the daemon's helpers above them, by what Slurm puts into their environment.
processes_of() {
    local environment pid
    for environment in /proc/[0-9]*/environ; do
        pid="${environment//[^0-9]/}"
        if tr '\0' '\n' <"$environment" 2>/dev/null | grep -qx "SLURMD_NODENAME=$1"; then
            echo "$pid"
            awk '/^PPid:/ { print $2 }' "/proc/$pid/status"
        fi
    done 2>/dev/null | sort -un | while read -r pid; do
        grep -qE '^(slurmstepd|/bin/sh|.*slurm_script|.*aurt)' <(tr '\0' ' ' <"/proc/$pid/cmdline" 2>/dev/null) && echo "$pid"
    done
}
# Stops node2 and all that it runs where they are, so that nothing changes between looking and killing. Succeeds if a point
# is being computed there: which one, its own process says.
stopped_in_a_point() {
    local pid known=""
    # What is listed may start more before it is stopped.
    while mapfile -t victims < <(pid_of node2; processes_of node2) && [[ "${victims[*]}" != "$known" ]]; do
        known="${victims[*]}"
        kill -STOP "${victims[@]}" 2>/dev/null || true
    done
    lost=""
    for pid in "${victims[@]}"; do
        grep -q aurt "/proc/$pid/comm" 2>/dev/null || continue
        lost="$(tr '\0' '\n' <"/proc/$pid/environ" 2>/dev/null | sed -n 's/^SLURM_ARRAY_TASK_ID=//p')"
        [[ -n "$lost" ]] && break
    done
    # A point whose result is there has been computed, though its process may still be ending.
    if [[ -n "$lost" ]] && ! has_result "$lost"; then return 0; fi
    lost=""
    kill -CONT "${victims[@]}" 2>/dev/null || true
    return 1
}
idle() { [[ -z "$(tasks)" ]]; }
caught_or_idle() { stopped_in_a_point || idle; }
# On a machine that is done before it is looked at, all begins again.
lost=""
while [[ -z "$lost" ]]; do
    rm -rf sweep
    submit
    wait_for caught_or_idle
done

say "kill -9 of node2, its daemon and all that it runs, in the middle of a point"
kill -9 "${victims[@]}" 2>/dev/null || true
echo "point $lost was running on node2; results so far: $(find sweep/results -name '*.json' | wc -l)"
down() { sinfo --noheader --nodes=node2 --format=%t | grep -q down; }
wait_for down
sinfo --Node --format='%N %t'
restarted() { scontrol --oneliner show job | grep -E "ArrayTaskId=$lost .*Restarts=[1-9]" >restarted.txt; }
wait_for restarted
sed -E 's/.*ArrayTaskId=([0-9]+) .*(Requeue=1 Restarts=[0-9]+).*/point \1: \2/' restarted.txt
wait_for idle

say "aurt sweep collect --out sweep"
aurt sweep collect --out sweep | grep -A 2 -E 'without a result|written' || true

say "aurt sweep run demo/sweep.toml --out sweep --engine slurm, again"
aurt sweep run demo/sweep.toml --out sweep --engine slurm
wait_for idle

say "aurt sweep collect --out sweep"
aurt sweep collect --out sweep

say "the same without Slurm, file by file"
"$AURT" sweep run demo/sweep.toml --out here --quiet >/dev/null
cmp_all() { diff --recursive --exclude=lock --exclude=slurm sweep here; }
cmp_all
echo "sweep and here: $(find here/results -name '*.json' | wc -l) results and both tables are byte-identical"
