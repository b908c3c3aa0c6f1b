#!/usr/bin/env bash
# A program for `aurt-lab prove --program`: calibrates a case on its calibration recordings alone and asks of its other recordings
# what that model lacks. `AURT` names the program; cases without targets are diagnosed as they are.
#
#     aurt-lab prove --world clean --plan nulls.toml --seed 123001 --program scripts/given-model.sh --out given
set -euo pipefail
aurt="${AURT:-aurt}"
if ! grep -q '^target' experiment.toml; then
    exec "$aurt" "$@"
fi
listed() { sed -n "s/^$1 = \[\(.*\)\]/\1/p" experiment.toml; }
later="$(listed target), $(listed validation)"
made="$(mktemp -d)"
trap 'rm -rf "$made" reference.toml question.toml' EXIT
sed '/^target/d; /^validation/d' experiment.toml >reference.toml
sed "s/^calibration.*/calibration = [$later]/; /^target/d; /^validation/d" experiment.toml >question.toml
"$aurt" run reference.toml --out "$made/model" >"$made/run.log" || (($? == 1))
"$aurt" diagnose question.toml --model "$made/model/rd_calibrated.json" "${@:3}"
