#!/usr/bin/env bash
# Builds the command `aurt` to be handed out: `scripts/release.sh` leaves it in target/handed-out/release/aurt.
#
# The folders of whoever builds it (sources, cargo's home) are not in it: the compiler writes others in their place, and the
# script looks whether one is left. Cargo's own way (`trim-paths`) is not in stable versions yet.
set -euo pipefail
cd "$(dirname "$0")/.."

here="$(pwd -P)"
home="$(cd "${CARGO_HOME:-$HOME/.cargo}" && pwd -P)"
separator=$'\x1f'
CARGO_ENCODED_RUSTFLAGS="--remap-path-prefix=$home=/cargo${separator}--remap-path-prefix=$here=/aurt"
AURT_RELEASE=1
export CARGO_ENCODED_RUSTFLAGS AURT_RELEASE
cargo build --release --locked --target-dir target/handed-out

program=target/handed-out/release/aurt
for folder in "$here/" "$home/" "$HOME/"; do
    if grep -aqF "$folder" "$program"; then
        echo "$program names the folder $folder:" >&2
        strings -a "$program" | grep -F "$folder" | head -n 3 >&2
        exit 1
    fi
done
echo "$program: $(wc -c <"$program") bytes, no folder of this machine in it"
