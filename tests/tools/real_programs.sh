#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The real programs on the real machine: simulate, then replay. What does not carry says why.
# Example: tests/tools/real_programs.sh build/host-release
#          tests/tools/real_programs.sh build/host-release pages    # in stoppable mode, with a page
#                                     and a picture of its first screen for each
#                                     (docs/guide/report.md)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
axguard=$(realpath "${1:-$root/build/host-release}")/axguard
data=$(realpath "${AXG_SHARED_DATA:-$root/../shared/data}")
meshes=$data/machines/probe-basic-xyzac
machine=$root/config/machines/probe-basic-xyzac.yaml
pages=
if [[ -n ${2:-} ]]; then
    mkdir -p "$2"
    pages=$(realpath "$2")
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$data/gcode"

show_page() { # NAME
    local code=0 start=$SECONDS
    mv "$folder/trace.log" "$folder/$1.log"
    (cd "$folder" && "$axguard" replay "$machine" "$1.log" --mesh-root "$meshes" \
        --details --report "$pages/$1.html") >"$folder/out" || code=$?
    rm "$folder/$1.log"
    echo "  replay: exit code $code, $((SECONDS - start)) s with the page's clearances"
    sed -n 's/^\(queries per cycle.*\)/  \1/p; s/^\(no stop.*\)/  \1/p; /^STOP/,$ s/^/  /p' \
        "$folder/out"
    python3 -B "$root/tests/browser/screenshot.py" "$pages/$1.html" "$pages/$1.png"
}

carry() { # PROGRAM OPTION...
    local program=$1 code=0
    shift
    printf '\n%s %s\n' "$program" "$*"
    "$axguard" simulate "$machine" "$program" -o "$folder/trace.log" --max-errors 1000 "$@" \
        >"$folder/out" 2>"$folder/err" || code=$?
    if [[ $code -ne 0 ]]; then # each word once, with how often it stops the program
        sed -n "s/^$program:\([0-9]*\): \([^:]*\): .*/\2 \1/p" "$folder/err" | grep -v '^M42[89]' |
            awk '{ count[$1]++; if (!($1 in first)) first[$1] = $2 }
                 END { for (w in count) printf "  %s line %d (%d)\n", w, first[w], count[w] }' |
            sort
        echo "  simulate: exit code $code"
        return
    fi
    sed -n "s|^$folder/trace.log: |  |p" "$folder/out"
    if [[ -n $pages ]]; then
        local name=${program%.ngc}
        [[ ! -e $pages/$name.html ]] || name+=-2
        show_page "$name"
        return
    fi
    "$axguard" replay "$machine" "$folder/trace.log" --mode contact --mesh-root "$meshes" \
        --deadline-us 10000000 --details >"$folder/out" || code=$?
    sed -n 's/^\(cycle  .*\)  *sum of.*/  \1/p; s/^\(no stop.*\)/  \1/p; /^STOP/,$ s/^/  /p' \
        "$folder/out"
    echo "  replay: exit code $code"
}

[[ -n $pages ]] ||
    printf '%35s%10s%10s%10s  (us, 15 pairs and 2 canaries)\n' AVG MIN MAX p99
carry impeller_xyzac.ngc --work-offset 'G54 Z-300'
carry impeller_xyzac.ngc --work-offset 'G54 Z-400'
carry impeller-7bl-xyzac.ngc --work-offset 'G54 Z-350'
carry boat-xyzac.ngc --tool 1=150 --work-offset 'G54 Z-336.55'
carry cds.ngc --tool 1=150 --work-offset 'G54 Z-110'
carry xyz_box_inscribed_face_circles_test.ngc --tool 8=150 --work-offset 'G54 Z-140'
carry xyzac_switchkins_test_3.ngc
carry duplicate_tool_test_gcode.ngc --tool 8=150 --tool 21=150 --tool 48=150 --tool 52=150 \
    --work-offset 'G54 Z-110'
carry helix_ac.ngc
carry xyzac_switchkins_test_1.ngc
carry xyzac_switchkins_test_2.ngc
