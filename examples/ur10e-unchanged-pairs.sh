#!/usr/bin/env bash
# Every unloaded UR10e recording as the question, every other one to calibrate on (with the argument 2: every two
# others): what is said to have changed? Prints those in which it is something else than friction, and how many there are.
#   AURT_DATA=/path/to/recordings examples/ur10e-unchanged-pairs.sh [2]
set -euo pipefail
cd "$(dirname "$0")/.."
: "${AURT_DATA:?set it to the folder of the recordings; docs/real-recordings.md says which}"
cargo build --release --quiet
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
recordings=(excitation_20s excitation_30s excitation_50s unloaded_50s point_to_point joint_1_only)
friction='coulomb|coulomb_asymmetry|friction_level_changed|load_dependent_friction|presliding_hysteresis|stribeck'
friction+='|temperature_dependent_friction|viscous|viscous_asymmetry|viscous_nonlinear'
calibrations=()
for ((i = 0; i < ${#recordings[@]}; i++)); do
    [[ "${1:-1}" == 2 ]] || calibrations+=("${recordings[i]}")
    for ((j = i + 1; j < ${#recordings[@]}; j++)); do
        [[ "${1:-1}" != 2 ]] || calibrations+=("${recordings[i]} ${recordings[j]}")
    done
done
asked=0 changed=0 frictional=0
for known in "${calibrations[@]}"; do
    listed="$(printf '"${AURT_DATA}/ur10e/%s.csv", ' $known)"
    for question in "${recordings[@]}"; do
        [[ " $known " != *" $question "* ]] || continue
        sed -e "s#^calibration *=.*#calibration = [$listed]#" \
            -e "s#^validation *=.*#target = [\"\${AURT_DATA}/ur10e/$question.csv\"]#" \
            examples/diagnose_ur10e_structure.toml >"$scratch/pair.toml"
        status=0
        target/release/aurt diagnose "$scratch/pair.toml" --out "$scratch/out" --verdict-only --json \
            >"$scratch/verdict.json" || status=$?
        ((status <= 1)) || exit "$status"
        asked=$((asked + 1))
        found="$(tr -d ' \n' <"$scratch/verdict.json" \
            | grep -oE '[[,]\{"effect":"[a-z_]+","family":"[A-Z]","joints":\[[0-9,]*\],"present_in":\["target"\]' || true)"
        others="$(grep -vE "^$|\"effect\":\"($friction)\"" <<<"$found" || true)"
        ! grep -qE "\"effect\":\"($friction)\"" <<<"$found" || frictional=$((frictional + 1))
        if [[ -n "$others" ]]; then
            changed=$((changed + 1))
            echo "$known, then $question: $others"
        fi
    done
done
echo "$changed of $asked show a change that is not friction, $frictional one of friction"
