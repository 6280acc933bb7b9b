#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One line a file that the workbench makes of every shipped machine and program: its SHA-256, and
# what it is.
# Example: tests/tools/shipped_bytes.sh build/host-release >after.txt
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
axguard=$(realpath "${1:?usage: shipped_bytes.sh BUILD_FOLDER}")/axguard
meshes=${AXG_SHARED_DATA:-$root/../shared/data}/machines/probe-basic-xyzac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$root"

made() { # WHAT FILE...
    local what=$1 file
    shift
    for file in "$@"; do
        printf '%s  %s %s\n' "$(sha256sum <"$file" | cut -c1-16)" "$what" "$(basename "$file")"
    done
}

run() { # exit codes are part of what is compared
    local code=0
    "$axguard" "$@" >/dev/null 2>&1 || code=$?
    echo "$code" >"$folder/exit"
}

for machine in config/machines/*.yaml; do
    name=$(basename "$machine" .yaml)
    more=()
    if [[ $name == probe-basic-xyzac ]]; then
        [[ -d $meshes ]] || continue
        more=(--mesh-root "$meshes")
    fi
    run compile "$machine" "${more[@]}" -o "$folder/machine.axg"
    made "$name compile" "$folder/exit" "$folder/machine.axg"
    rm -f "$folder/machine.axg"
done
for program in hil_replay/programs/*.ngc; do
    name=$(basename "$program" .ngc)
    machine=config/machines/$name.yaml
    while [[ ! -e $machine ]]; do
        machine=${machine%-*}.yaml
    done
    for more in "" --fd --axis-by-axis; do
        run simulate "$machine" "$program" -o "$folder/trace.log" $more
        made "$name simulate $more" "$folder/exit" "$folder/trace.log"
    done
    run simulate "$machine" "$program" -o "$folder/trace.log" --sample-us 2000
    for mode in contact stoppable; do
        run replay "$machine" "$folder/trace.log" --mode "$mode" --keep-going --engine cpu \
            --deadline-us 10000000 --csv "$folder/replay.csv" --frames-out "$folder/frames.log"
        made "$name replay $mode" "$folder/exit" "$folder/replay.csv" "$folder/frames.log"
        run drive "$machine" "$program" --mode "$mode" --engine cpu --csv "$folder/drive.csv"
        made "$name drive $mode" "$folder/exit" "$folder/drive.csv"
    done
done
