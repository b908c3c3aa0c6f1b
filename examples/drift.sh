#!/usr/bin/env bash
# A simulated UR10e whose joint 2 rubs more from night to night, and what `aurt track` says of it.
#   examples/drift.sh
# With a number, as many hours in which nothing changes instead: logs of ten minutes, cut by the clock in the middle of a motion into
# pieces with gaps, four hours a machine with a calibration of its own; how many alarms there are with one false alarm in 1 h asked
# for, and with the default of 720 h. A second number is the first seed.
set -euo pipefail
cd "$(dirname "$0")/.."
[[ -n "${AURT:-}" ]] || cargo build --release --quiet
aurt="${AURT:-$PWD/target/release/aurt}"
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
coulomb = { model = "constant" }
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
calibrated() { # first seed
    for k in 1 2 3; do
        simulated "$(($1 + k))" 120.0 0 "unchanged_$k.csv"
    done
    "$aurt" run experiment.toml --out results --quiet
}
mkdir nights
track=("$aurt" track experiment.toml --model results/rd_calibrated.json)
if (($# == 0)); then
    calibrated 0
    night=0
    for growth in 0 0 0.05 0.1 0.15 0.2; do
        night=$((night + 1))
        simulated "$((10 + night))" 60.0 "$growth" "nights/$night.csv"
    done
    "${track[@]}" nights --out track || (($? == 1))
    exit 0
fi
cut_by_the_clock() { # seed, file: pieces of about a minute in `nights`, three gaps of up to 3 s in each
    awk -F, -v seed="$1" '
        NR == 1 { header = $0; srand(seed); next }
        piece == 0 && $1 < 2 { next }
        piece == 0 || $1 > end {
            file = sprintf("nights/%06d_%02d.csv", seed, ++piece)
            print header >file
            end = $1 + 40 + 40 * rand()
            for (k = 0; k < 3; k++) { from[k] = $1 + 60 * rand(); to[k] = from[k] + 0.15 + 3 * rand() * rand() }
        }
        $1 > 598 { exit }
        { for (k = 0; k < 3; k++) if ($1 > from[k] && $1 < to[k]) next; print >file }' "$2"
}
counted() { # options; nothing but alarms of a chart ends with 1
    "${track[@]}" nights "$@" --out track --json >track.out || (($? == 1))
    grep -c '"since_recording"' track.out || true
}
often=0
seldom=0
for ((hour = 0; hour < $1; hour += 4)); do
    seed=$((${2:-1000} + 10 * hour))
    calibrated "$seed"
    for ((k = 4; k < 28; k++)); do
        simulated "$((seed + k))" 600.0 0 whole.csv
        cut_by_the_clock "$((seed + k))" whole.csv
    done
    often=$((often + $(counted --false-alarm-h 1)))
    seldom=$((seldom + $(counted)))
    rm nights/*.csv
    echo "$((hour + 4)) h without a change: $often alarms with one in 1 h asked for, $seldom with one in 720 h"
done
