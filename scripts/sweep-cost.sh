#!/usr/bin/env bash
# What one more linear variant of a sweep costs, in processor time on one thread, as a share of the first variant's
# full time (program start, reading, preprocessing, rigid bodies, its own fit and errors, results and tables).
#
#   AURT_DATA=/path/to/recordings scripts/sweep-cost.sh
#
# The variants are those of examples/ur10e_hundred_variants.toml; the first alone is the reference, in the same run.
# AURT names the program; without it, it is built.
set -euo pipefail
cd "$(dirname "$0")/.."
: "${AURT_DATA:?set it to the folder of the recordings, see docs/real-recordings.md}"
if [[ -z "${AURT:-}" ]]; then
    cargo build --quiet --release
    AURT="$(cargo metadata --format-version 1 --no-deps | sed -E 's/.*"target_directory":"([^"]*)".*/\1/')/release/aurt"
fi
export RAYON_NUM_THREADS=1
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

all=examples/ur10e_hundred_variants.toml
sed '/^\[sweep.grid\]/,$d' "$all" >"$scratch/first.toml"
printf '[[sweep.variant]]\nname = "first"\n' >>"$scratch/first.toml"

# User and system time of a sweep in a new folder, in ms: the median of five.
TIMEFORMAT='%U %S'
milliseconds() {
    for _ in 1 2 3 4 5; do
        rm -rf "$scratch/out"
        { time "$AURT" sweep run "$1" --out "$scratch/out" --quiet >/dev/null; } 2>&1 |
            awk '{ printf "%.0f\n", 1000 * ($1 + $2) }'
    done | sort -n | sed -n 3p
}
first="$(milliseconds "$scratch/first.toml")"
together="$(milliseconds "$all")"
points="$(find "$scratch/out/results" -name '*.json' | wc -l)"
awk -v first="$first" -v together="$together" -v points="$points" 'BEGIN {
    further = (together - first) / (points - 1)
    printf "first variant %d ms, %d variants %d ms: %.2f ms for each further variant, %.1f %% of the first\n",
        first, points, together, further, 100 * further / first
}'
