#!/usr/bin/env bash
# The six friction configurations of the paper on the UR10e as it was logged: normalised RMS error in % on the
# held-out recordings, joints 0 to 5. Needs the recordings of examples/ur10e.toml in the folder AURT_DATA.
#
#   AURT_DATA=/path/to/recordings examples/ur10e-friction-table.sh
set -euo pipefail
cd "$(dirname "$0")/.."
: "${AURT_DATA:?set it to the folder of the recordings, see docs/real-recordings.md}"

cargo build --quiet --release
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

echo "| recording | samples | friction | 0 | 1 | 2 | 3 | 4 | 5 |"
echo "|---|---|---|---|---|---|---|---|---|"
for recording in excitation_20s point_to_point; do
    for samples in all moving; do
        for coulomb in none square absolute; do
            for powers in "1" "1, 2, 3"; do
                report="$scratch/$coulomb-$powers"
                if [[ ! -f "$report" ]]; then
                    sed -e "s/coulomb = .*/coulomb = { model = \"$coulomb\" }/" -e "s/powers = .*\]/powers = [$powers]/" \
                        examples/ur10e.toml >"$scratch/experiment.toml"
                    cargo run --quiet --release -- run "$scratch/experiment.toml" --out "$scratch/out" >"$report"
                fi
                # The columns of the report: joint, MSE, NMSE, NRMS over all rows, then rows and the same moving.
                awk -v recording="$recording" -v column="$([[ $samples == all ]] && echo 4 || echo 8)" \
                    -v row="| $recording | $samples | $coulomb {$powers}" '
                    /^[^ ]/ { inside = index($0, recording ".csv (validation") > 0 }
                    inside && /^ +[0-9]+ / { row = row " | " $column }
                    END { print row " |" }' "$report"
            done
        done
    done
done
