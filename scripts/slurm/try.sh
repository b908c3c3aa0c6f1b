#!/usr/bin/env bash
# Sweeps, proofs and fleets on a real Slurm, on one machine: a controller and two nodes. Their tasks are killed while they compute and
# start again; the results are compared, byte for byte, with those of one process.
#
#   sudo scripts/slurm/try.sh
#
# Each step waits for the state that the next one needs, however long that takes; it gives up where nothing has changed for
# five minutes. Configuration, key, state and logs lie in a folder of their own, so a Slurm that the machine already has is not
# touched. Needs root and, on Debian or Ubuntu, `apt-get install slurm-wlm munge`; without them it says that it is skipped. AURT names
# the program to try, with aurt-lab beside it; without it, both are built.
set -euo pipefail
cd "$(dirname "$0")/../.."

((EUID == 0)) || { echo "skipped: Slurm's daemons want to be started by root"; exit 0; }
for program in munged slurmctld slurmd sbatch python3; do
    command -v "$program" >/dev/null || { echo "skipped: there is no $program (apt-get install slurm-wlm munge python3)"; exit 0; }
done
if [[ -z "${AURT:-}" ]]; then
    cargo build --quiet --release -p aurt-cli -p aurt-lab
    AURT="$(cargo metadata --format-version 1 --no-deps | sed -E 's/.*"target_directory":"([^"]*)".*/\1/')/release/aurt"
fi
AURT="$(realpath "$AURT")"
LAB="$(dirname "$AURT")/aurt-lab"
FLEET="$PWD/scripts/fleet.py"

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
say() { printf '\n# %s\n' "$1"; }
show() { sed "s|$scratch/||g; s|$scratch|.|g; s|$LAB|aurt-lab|g; s|$AURT|aurt|g; s|$FLEET|fleet.py|g"; }
same() { diff --recursive --exclude=lock --exclude=slurm "$1" "$2"; }
aurt() { "$AURT" "$@" 2>&1 | show; return "${PIPESTATUS[0]}"; }
tasks() { squeue --noheader --array --format='%K %T %N %r' | sort -n; }
has_result() {
    local key
    key="$(grep -o '"key": *"[0-9a-f]*"' sweep/sweep.json | sed -n "${1}s/.*\"\([0-9a-f]*\)\"/\1/p")"
    [[ -e "sweep/results/$key.json" ]]
}
seen() { tasks; sinfo --noheader --Node --format='%N %t'; find "$scratch" -name '*.json' | wc -l; }
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

start_slurm
nodes_are() { [[ "$(sinfo --noheader --Node --format='%N %t' | tr '\n' ' ')" == "$1" ]]; }
wait_for nodes_are "node1 idle node2 idle "
sinfo --Node --format='%N %t'

cd "$scratch"
"$AURT" demo --out demo --quiet >/dev/null
sed '/^\[\[joint_dynamics.override\]\]/,/^\[recordings\]/{/^\[recordings\]/!d}' demo/experiment.toml >demo/sweep.toml
for coulomb in constant absolute; do
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
same sweep here
echo "sweep and here: $(find here/results -name '*.json' | wc -l) results and both tables are byte-identical"

# Submits tasks, each the same command.
array_of() {
    say "sbatch --array=$1 --wrap '$(show <<<"$2")'"
    array="$(sbatch --parsable --array="$1" --output="$scratch/%A_%a.out" --wrap "$2")"
}
state_of() { scontrol --oneliner show job "${array}_$1" | sed -n 's/.*JobState=\([A-Z]*\).*/\1/p'; }
has_ended() { [[ "$(state_of "$1")" != RUNNING && "$(state_of "$1")" != COMPLETING ]]; }
# Kills, once, every task of the array that is seen to compute (`kill_task` says how) and lets Slurm start it again, until all are done.
killed_until_idle() {
    local task
    for task in $(tasks | awk '$2 == "RUNNING" { print $1 }'); do
        [[ "$killed" != *" $task "* ]] && kill_task "$task" || continue
        wait_for has_ended "$task"
        [[ "$(state_of "$task")" != COMPLETED ]] || continue
        killed+="$task "
        scontrol requeue "${array}_$task"
    done
    idle
}
kill_and_requeue() {
    killed=" "
    wait_for killed_until_idle
    [[ "$killed" != " " ]] || { echo "no task could be killed before it was done" >&2; exit 1; }
    local restarts
    restarts="$(scontrol --oneliner show job "$array" | grep -cE 'Restarts=[1-9]')"
    [[ "$restarts" == "$(wc -w <<<"$killed")" ]] || { echo "killed$killed, but Slurm has started $restarts again" >&2; exit 1; }
    echo "killed and started again: tasks${killed% }"
}

cat >plan.toml <<PLAN
[recordings]
duration_s = 60.0
rate_hz = 125.0
[nulls]
robots = ["two_link"]
count = 8
[singles]
robots = ["two_link"]
trials = 2
strengths = ["medium", "strong"]
effects = ["payload", "base_tilt", "stribeck", "torque_constant", "external_contact"]
PLAN
proof="$LAB prove --world clean --plan $scratch/plan.toml --seed 7 --quiet"
array_of 1-4 "$proof --shard \$SLURM_ARRAY_TASK_ID/4 --out $scratch/part\$SLURM_ARRAY_TASK_ID"
say "scancel --signal=KILL of each shard that has diagnosed a case, and scontrol requeue"
kill_task() { compgen -G "part$1/*/verdicts/*/verdict.json" >/dev/null && scancel --signal=KILL --full "${array}_$1"; }
kill_and_requeue
"$LAB" prove --collect part1 part2 part3 part4 --out together --quiet >/dev/null
$proof --out whole >/dev/null
same together whole
echo "together and whole: $(find whole -name verdict.json | wc -l) verdicts and the scoreboard are byte-identical"

# Three nights of seven machines: 0 is as it was calibrated, joint 2 of 5 and 6 rubs more.
machine='robot = "ur10e"
motion = { kind = "multi_sine", duration_s = 300.0, harmonics = 8, top_hz = 1.0, share = 0.6 }
logger = { rate_hz = 500 }'
rubs='effect = [{ name = "friction_level_changed", joints = [2], coulomb_change = [0.2], viscous_change = [0.2] }]'
echo name,experiment,model,recordings >robots.csv
for robot in 0 1 2 3 4 5 6; do
    mkdir -p "logs/$robot"
    for night in 1 2 3; do
        printf '%s\n' "$machine" "seed = $((10 * robot + night))" "$( ((robot < 5)) || echo "$rubs")" >scenario.toml
        "$AURT" simulate --scenario scenario.toml --out "logs/$robot/$night.csv" --quiet
    done
    ((robot == 0)) || echo "robot $robot,demo/fleet.toml,fleet-model/rd_calibrated.json,logs/$robot" >>robots.csv
done
sed -E 's|^calibration = .*|calibration = ["../logs/0/1.csv", "../logs/0/2.csv"]|; s|^validation = .*|validation = ["../logs/0/3.csv"]|' \
    demo/experiment.toml >demo/fleet.toml
"$AURT" run demo/fleet.toml --out fleet-model --quiet >/dev/null
follow="python3 $FLEET $scratch/robots.csv --aurt $AURT"
array_of 0-5 "$follow --out $scratch/fleet --index \$SLURM_ARRAY_TASK_ID"
say "kill -9 of each \`aurt track\` that is seen, which fails its task, and scontrol requeue"
kill_task() { pkill -KILL -f "^$AURT track .*--out $scratch/fleet/robot $(($1 + 1)) "; }
kill_and_requeue
status=0
$follow --out fleet --table || status=$?
$follow --out alone >/dev/null || (($? == status))
same fleet alone
echo "fleet and alone: the results of $(find alone -name track.json | wc -l) robots and the table are byte-identical"
