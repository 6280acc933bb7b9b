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
cmake --preset host-benchmarks >/dev/null
cmake --build --preset host-benchmarks --target peers axg_make_scene >/dev/null
programs=$root/build/host-benchmarks/tests
rm -rf "$out"
mkdir -p "$out"
"$programs/axg_make_scene" config/machines/paper-trunnion.yaml "$out/scene" --poses "$poses" \
    --seed "$seed" --near --focus cutter-c
"$programs/peers" "$out/scene" --csv "$out/peers.csv" --json "$out/peers.json"
