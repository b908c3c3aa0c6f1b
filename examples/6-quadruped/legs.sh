#!/bin/sh
# The legs one by one, as chains of three joints: go2.toml with a tip and the columns of a leg.
#
#   AURT_DATA=/path/to/recordings sh examples/6-quadruped/legs.sh FOLDER
set -eu
here=$(dirname "$0")
mkdir -p "$1"
first=1
for leg in FL FR RL RR; do
    sed -e "s/^base = .*/&\ntip = \"${leg}_calf\"/" \
        -e "s/\[1, 12\]/[$first, $((first + 2))]/" \
        -e "s/\[13, 24\]/[$((first + 12)), $((first + 14))]/" "$here/go2.toml" > "$1/$leg.toml"
    "${AURT:-aurt}" run "$1/$leg.toml" --out "$1/$leg"
    first=$((first + 3))
done
