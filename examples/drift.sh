#!/usr/bin/env bash
# A simulated UR10e whose joint 2 rubs more from night to night, and what `aurt track` says of it.
#   examples/drift.sh
# With a number, as many nights in which nothing changes instead, ten at a time judged with one false alarm in 0.25 h, and all
# together with the default of 720 h: how many alarms there are. A second number is the first night's seed.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --quiet
aurt="$PWD/target/release/aurt"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

simulated() { # seed, seconds, share by which friction of joint 2 grows, file
    {
        printf 'robot = "ur10e"\nseed = %s\n[motion]\nkind = "multi_sine"\nduration_s = %s\n' "$1" "$2"
        printf 'harmonics = 8\ntop_hz = 1.0\nshare = 0.6\n[logger]\nrate_hz = 125\n'
        if [[ "$3" != 0 ]]; then
            printf '[[effect]]\nname = "friction_level_changed"\njoints = [2]\n'
            printf 'coulomb_change = [%s]\nviscous_change = [%s]\n' "$3" "$3"
        fi
    } >scenario.toml
    "$aurt" simulate --scenario scenario.toml --out "$4" --quiet
}

cat >mdh.csv <<'CSV'
alpha,a,d
pi/2,0,0.1807
0,-0.6127,0
0,-0.57155,0
pi/2,0,0.17415
-pi/2,0,0.11985
0,0,0.11655
CSV
cat >experiment.toml <<'TOML'
schema = 1
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0.0, 0.0, -9.81]
torque_constants_nm_per_a = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
[joint_dynamics]
coulomb = { model = "none" }
hysteresis = { model = "sign" }
viscous = { model = "polynomial", powers = [1] }
[[arm_terms]]
model = "rotor_inertia"
joints = [2, 3, 4, 5]
[recordings]
calibration = ["unchanged_1.csv"]
validation = ["unchanged_2.csv", "unchanged_3.csv"]
[preprocess]
f_dyn_hz = 5.0
TOML
for k in 1 2 3; do
    simulated "$k" 120.0 0 "unchanged_$k.csv"
done
"$aurt" run experiment.toml --out results --quiet
mkdir nights
track=("$aurt" track experiment.toml --model results/rd_calibrated.json)
if (($# == 0)); then
    night=0
    for growth in 0 0 0.05 0.1 0.15 0.2; do
        night=$((night + 1))
        simulated "$((10 + night))" 60.0 "$growth" "nights/$night.csv"
    done
    "${track[@]}" nights --out track || (($? == 1))
    exit 0
fi
counted() { # folder or files, options; nothing but alarms of a chart ends with 1
    "${track[@]}" "$@" --out track --json >track.out || (($? == 1))
    grep -c '"since_recording"' track.out || true
}
alarms=0
mkdir all
for ((night = 0; night < $1; night += 10)); do
    for k in 0 1 2 3 4 5 6 7 8 9; do
        simulated "$((${2:-100} + night + k))" 60.0 0 "nights/$k.csv"
    done
    alarms=$((alarms + $(counted nights --false-alarm-h 0.25)))
    for k in 0 1 2 3 4 5 6 7 8 9; do
        mv "nights/$k.csv" "all/$(printf '%06d' $((night + k))).csv"
    done
done
echo "$alarms alarms in $1 minutes without a change, one in 0.25 h asked for"
echo "$(counted all) alarms in $1 minutes without a change, one in 720 h asked for"
