#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Where the head of the real machine first meets its trunnion on the way down, by simulate and
# replay: nine positions, margin 0, no tool. Beside it what other code measured on the same meshes.
# Example: tests/tools/first_contacts.sh build/host-release
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
axguard=$(realpath "${1:-$root/build/host-release}")/axguard
meshes=${AXG_SHARED_DATA:-$root/../shared/data}/machines/probe-basic-xyzac
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

sed -e 's/margin_mm: 0.5/margin_mm: 0/' -e 's/^tools:/first_tool: 0\ntools:/' \
    "$root/config/machines/probe-basic-xyzac.yaml" >"$folder/machine.yaml"

descend() { # POSE WANTED
    {
        printf '%s\n' 'G20 G90' 'G53 G0 Z3' "G53 G0 $1"
        for step in $(seq 2.5 -0.5 -18); do
            printf '%s\n' "G53 G0 Z$step" 'G4 P0.01'
        done
        echo M2
    } >"$folder/down.ngc"
    "$axguard" simulate "$folder/machine.yaml" "$folder/down.ngc" -o "$folder/down.log" >/dev/null
    local code=0
    "$axguard" replay "$folder/machine.yaml" "$folder/down.log" --mesh-root "$meshes" \
        --mode contact --json="$folder/down.json" >/dev/null || code=$?
    python3 - "$folder/down.json" "$1" "$2" "$code" <<'END'
import json, math, sys
document, pose, wanted, code = sys.argv[1:]
stops = json.load(open(document))["stops"]
if not stops:
    print(f"{pose:10}  no contact, exit code {code}; measured: {wanted}")
    sys.exit(0)
z_in = stops[0]["axes"]["Z_mm"] / 25.4
step = math.floor(z_in * 2 + 1e-9) / 2
print(f"{pose:10}  stop at Z {z_in:10.5f} in, {stops[0]['pair']:16}  first of the steps {step:5g}"
      f"   measured: {wanted}")
END
}

descend 'X0 A0' 'none down to -18, where the nose lies in the plane of the plate'
descend 'X12.5 A0' '-14   headstock-a_axis'
descend 'X-12.5 A0' '-14   headstock-a_axis'
descend 'X10 A0' '-15.5'
descend 'X8 A0' '-17'
descend 'X0 A30' '-17.5 headstock-c_axis'
descend 'X0 A60' '-15   headstock-c_axis'
descend 'X0 A90' '-14   headstock-a_axis'
descend 'X0 A-90' '-14   headstock-a_axis'
