#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A scene near contact, `axguard-lab query` on it, and CGAL's exact judgement of every answer. Then
# the judge is judged: answers that are all "apart", and all "hit", must both be refused.
# Example: tests/oracle/exact_scene.sh build/host-release 2000
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(cd "${1:?usage: exact_scene.sh BUILD_FOLDER [POSES]}" && pwd)
poses=${2:-$((200 / ${AXG_COUNT_DIVISOR:-1}))}
seed=${AXG_SEED:-3}
machine=${AXG_MACHINE:-$root/config/machines/paper-trunnion.yaml}
for needed in "$machine" "$build/axguard-lab" "$build/tests/axg_make_scene" \
    "$build/tests/axg_exact_scene"; do
    if [[ ! -e $needed ]]; then
        echo "skipped: no $needed"
        exit 77
    fi
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$build/tests/axg_make_scene" "$machine" "$folder/scene" --poses "$poses" --seed "$seed" --near \
    --focus cutter-c
judge=("$build/tests/axg_exact_scene" "$folder/scene")
for ask in hit count clearance; do
    "$build/axguard-lab" query "$folder/scene" --engine cpu --ask "$ask" -o "$folder/$ask.csv" \
        >/dev/null
    echo "--ask $ask (seed $seed):"
    "${judge[@]}" "$folder/$ask.csv"
done

doctored() { # HIT: all answers become this one
    awk -F, -v OFS=, -v hit="$1" 'NR > 1 { $3 = hit; $4 = ""; $5 = "" } 1' "$folder/hit.csv" \
        >"$folder/doctored.csv"
    if "${judge[@]}" "$folder/doctored.csv" >/dev/null; then
        echo "the judge passes answers that all say hit = $1: is there no contact in the scene?" >&2
        exit 1
    fi
}
doctored 0
doctored 1
