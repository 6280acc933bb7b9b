#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the benchmark, makes the scene (the paper's machine, near contact) and runs it.
# Example: tests/benchmarks/peers.sh 2000 build/peers    poses, folder for scene and results
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
poses=${1:-2000}
out=${2:-$root/build/peers}
seed=${AXG_SEED:-3}
cd "$root"
# Coal is not in Debian: from PyPI into a folder of its own, or left out where there is no network.
coal=${AXG_COAL:-}
if [[ -z $coal ]]; then
    venv=$root/build/coal
    if [[ -d $venv ]] || { python3 -m venv "$venv" &&
        "$venv/bin/pip" -q install --require-hashes -r tests/benchmarks/requirements.txt; }; then
        coal=$(echo "$venv"/lib/python3*/site-packages/cmeel.prefix)
    else
        rm -rf "$venv"
        echo "without Coal: PyPI cannot be reached (AXG_COAL=FOLDER names one that is installed)"
    fi
fi
cmake --preset host-benchmarks -DAXG_COAL="$coal" >/dev/null
cmake --build --preset host-benchmarks --target peers axg_make_scene >/dev/null
programs=$root/build/host-benchmarks/tests
rm -rf "$out"
mkdir -p "$out"
"$programs/axg_make_scene" config/machines/paper-trunnion.yaml "$out/scene" --poses "$poses" \
    --seed "$seed" --near --focus cutter-c
"$programs/peers" "$out/scene" --csv "$out/peers.csv" --json "$out/peers.json" \
    --records "$out/records.csv"
