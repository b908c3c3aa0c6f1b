#!/usr/bin/env bash
# Prepares a release in target/handed-out/upload: crates in the order of publication, the program, the Python wheel, bills of
# materials, SHA-256 sums. Nothing is uploaded; the last lines name what remains. Arguments go to `cargo package`
# (`--no-verify` does not build the packed crates). Needs maturin, ziglang and auditwheel (pip); without ziglang the wheel is for this machine.
#
# Folders of the building machine (sources, cargo's home) are not in program and wheel: the compiler writes others in their place,
# and the script searches for the rest. Cargo's own way (`trim-paths`) is not in stable versions yet.
set -euo pipefail
cd "$(dirname "$0")/.."

here="$(pwd -P)"
home="$(cd "${CARGO_HOME:-$HOME/.cargo}" && pwd -P)"
separator=$'\x1f'
CARGO_ENCODED_RUSTFLAGS="--remap-path-prefix=$home=/cargo${separator}--remap-path-prefix=$here=/aurt"
CARGO_TARGET_DIR=target/handed-out
AURT_RELEASE=1
export CARGO_ENCODED_RUSTFLAGS CARGO_TARGET_DIR AURT_RELEASE
upload=target/handed-out/upload
rm -rf "$upload"
mkdir -p "$upload"

without_folders() {
    for folder in "$here/" "$home/" "$HOME/"; do
        if grep -aqF "$folder" "$1"; then
            echo "$1 names the folder $folder:" >&2
            strings -a "$1" | grep -F "$folder" | head -n 3 >&2
            exit 1
        fi
    done
    echo "$1: $(wc -c <"$1") bytes, no folder of this machine in it"
}

version="$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"$/\1/p' Cargo.toml)"
same=yes
for file in python/Cargo.toml CITATION.cff; do
    grep -qE "^version( =|:) \"?${version//./\\.}\"?$" "$file" || { echo "$file has another version than $version" >&2; same=; }
done
if grep -E '^aurt.*version = ' Cargo.toml | grep -vF "version = \"$version\""; then
    echo "Cargo.toml asks for other versions of our crates than $version" >&2
    same=
fi
[[ -n "$same" ]] || exit 1

cargo package --workspace --locked --exclude aurt-lab --exclude aurt-tests --exclude aurt-plugin-example "$@" 2>&1 |
    tee "$upload/crates.log" | grep -vE '^ +(Updating|Compiling|Downloaded)|^warning: manifest|^ +[|=]'
sed -nE 's/^ +Packaging (\S+) v.*/\1/p' "$upload/crates.log" >"$upload/crates.txt"
rm "$upload/crates.log"
sed "s|.*|target/handed-out/package/&-$version.crate|" "$upload/crates.txt" | xargs cp -t "$upload"

cargo build --release --locked
without_folders target/handed-out/release/aurt
cp target/handed-out/release/aurt "$upload"

portable=(--zig --compatibility manylinux2014)
python3 -m ziglang version >/dev/null 2>&1 || portable=()
CARGO_TARGET_DIR=target/handed-out/python maturin build --quiet --release --locked --manifest-path python/Cargo.toml --out "$upload" \
    "${portable[@]}"
if ((${#portable[@]})); then
    auditwheel show "$upload"/*.whl | tee target/handed-out/auditwheel.log
    tr -d '\n' <target/handed-out/auditwheel.log | grep -q 'consistent with *the following platform tag: *"manylinux_2_17' || {
        echo "the wheel is not manylinux2014" >&2
        exit 1
    }
fi
rm -rf target/handed-out/unpacked
python3 -m zipfile -e "$upload"/*.whl target/handed-out/unpacked
without_folders target/handed-out/unpacked/aurt/_aurt.abi3.so

python3 scripts/sbom.py >"$upload/aurt.cdx.json"
python3 scripts/sbom.py --manifest python/Cargo.toml >"$upload/aurt-dynamics.cdx.json"
(cd "$upload" && sha256sum -- * >SHA256SUMS && cat SHA256SUMS)

echo "AURT $version is in $upload. Before the upload:"
grep -q '^repository = ' python/Cargo.toml || echo "  the manifests have no \`repository\`"
grep -qF "## $version" CHANGELOG.md || echo "  CHANGELOG.md has no section $version"
echo "  publish the crates of crates.txt in its order (cargo publish), the wheel on PyPI (twine upload)"
