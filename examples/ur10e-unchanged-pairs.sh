#!/usr/bin/env bash
# Every ordered pair of unloaded UR10e recordings, one to calibrate on and one as the question: what is said to have
# changed? Prints the pairs in which it is something else than friction, and how many there are.
#   AURT_DATA=/path/to/recordings examples/ur10e-unchanged-pairs.sh
set -euo pipefail
cd "$(dirname "$0")/.."
: "${AURT_DATA:?set it to the folder of the recordings; docs/real-recordings.md says which}"
cargo build --release --quiet
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
recordings=(excitation_20s excitation_30s excitation_50s unloaded_50s point_to_point joint_1_only)
friction='coulomb|coulomb_asymmetry|friction_level_changed|load_dependent_friction|presliding_hysteresis|stribeck'
friction+='|temperature_dependent_friction|viscous|viscous_asymmetry|viscous_nonlinear'
pairs=0 changed=0
for first in "${recordings[@]}"; do
    for second in "${recordings[@]}"; do
        [[ "$first" == "$second" ]] && continue
        sed -e "s#^calibration *=.*#calibration = [\"\${AURT_DATA}/ur10e/$first.csv\"]#" \
            -e "s#^validation *=.*#target = [\"\${AURT_DATA}/ur10e/$second.csv\"]#" \
            examples/diagnose_ur10e_structure.toml >"$scratch/pair.toml"
        status=0
        target/release/aurt diagnose "$scratch/pair.toml" --out "$scratch/out" --verdict-only --json \
            >"$scratch/verdict.json" || status=$?
        ((status <= 1)) || exit "$status"
        pairs=$((pairs + 1))
        others="$(tr -d ' \n' <"$scratch/verdict.json" \
            | grep -oE '[[,]\{"effect":"[a-z_]+","family":"[A-Z]","joints":\[[0-9,]*\],"present_in":\["target"\]' \
            | grep -vE "\"effect\":\"($friction)\"" || true)"
        if [[ -n "$others" ]]; then
            changed=$((changed + 1))
            echo "$first, then $second: $others"
        fi
    done
done
echo "$changed of $pairs pairs show a change that is not friction"
