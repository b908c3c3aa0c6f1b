#!/usr/bin/env bash
# Draws docs/pictures/report.png, the report of the demo's diagnosis in a browser (Chromium).
#   scripts/report-picture.sh target/release/aurt
set -euo pipefail
cd "$(dirname "$0")/.."

aurt="$(realpath "${1:-target/release/aurt}")"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
"$aurt" demo --quiet --out "$scratch/demo"
"$aurt" diagnose --quiet "$scratch/demo/later.toml" --out "$scratch/diagnosis" || (($? == 1))
browser="$(command -v chromium chromium-browser google-chrome | head -n 1)"
"$browser" --headless=new --no-sandbox --disable-gpu --hide-scrollbars --window-size=1000,945 \
    --screenshot="$PWD/docs/pictures/report.png" "file://$scratch/diagnosis/report.html" >/dev/null 2>&1
