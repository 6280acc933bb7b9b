#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# README's five steps on the real machine, as a new user takes them: its meshes as they are found,
# edits made by hand once and kept as a patch, one of its own programs. Prints what a user sees.
# Example: tests/tools/new_machine.sh build/host-release
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
PATH=$(realpath "${1:-$root/build/host-release}"):$PATH
data=${AXG_SHARED_DATA:-$root/../shared/data}
if [[ ! -d $data/machines/probe-basic-xyzac ]]; then
    echo "skipped: no $data/machines/probe-basic-xyzac; set AXG_SHARED_DATA"
    exit 77
fi
data=$(realpath "$data")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cp -r "$data/machines/probe-basic-xyzac" meshes
cp "$data/gcode/impeller_xyzac.ngc" "$root/docs/measurements/real-machine-edit.patch" .

step() { # EXIT_CODES COMMAND...
    local wanted=$1 start code=0
    shift
    printf '\n$ %s\n' "$*"
    start=${EPOCHREALTIME/,/.}
    "$@" 2>&1 || code=$?
    awk -v code="$code" -v start="$start" -v end="${EPOCHREALTIME/,/.}" \
        'BEGIN { printf "[exit code %s, %.2f s]\n", code, end - start }'
    [[ " $wanted " == *" $code "* ]] || exit 1
}

step 2 axguard init meshes -o my-machine.yaml
step 0 axguard init meshes -o my-machine.yaml --unit inch
step 0 axguard check my-machine.yaml
step 0 git apply -p0 real-machine-edit.patch
step 0 axguard check my-machine.yaml
step 3 axguard simulate my-machine.yaml impeller_xyzac.ngc -o impeller.log
step 0 axguard simulate my-machine.yaml impeller_xyzac.ngc -o impeller.log --ignore M428,M429 \
    --rotary programmed \
    --work-offset "G54 Z-100"
step "0 11" axguard replay my-machine.yaml impeller.log --mode contact
