#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every build gives the same answers, byte for byte: the engine in every set of lanes, `axguard
# query` on one scene near contact, and a simulated program replayed. Optimisation, compiler and
# processor may change the time, never a verdict. A build for AArch64 runs under qemu.
# Example: tests/tools/equal_verdicts.sh host-release host-debug host-clang jetson-thor
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if [[ $# -lt 2 ]]; then
    echo "usage: equal_verdicts.sh PRESET PRESET... (built before)" >&2
    exit 2
fi
poses=${AXG_VERDICT_POSES:-300}
seed=${AXG_SEED:-7}
machine=$root/config/machines/paper-trunnion.yaml
folder=$root/build/verdicts

program_of() { # PRESET PROGRAM ARGUMENT...
    local program=$root/build/$1/$2 emulator=()
    shift 2
    # e_machine of the ELF header: 183 is AArch64.
    if [[ $(od -An -j18 -N2 -tu2 "$program") -eq 183 && $(uname -m) != aarch64 ]]; then
        emulator=(qemu-aarch64 -L "${AXG_JETSON_SYSROOT:-$root/build/sysroot-arm64}")
    fi
    "${emulator[@]}" "$program" "$@"
}

axguard() { # PRESET ARGUMENT...
    program_of "$1" axguard "${@:2}"
}

# Hashes over every bit of the answers to random questions, and of the certified test.
wanted='' compared=()
for preset in "$@"; do
    for lanes in avx512 avx2 neon; do
        code=0
        line=$(program_of "$preset" tests/axg_lane_hash 3000 "$seed" "$lanes") || code=$?
        [[ $code -ne 77 ]] || continue # not on this processor
        compared+=("$preset $lanes")
        if [[ $code -ne 0 || $line != "${wanted:=$line}" ]]; then
            echo "equal_verdicts.sh: ${compared[0]}: $wanted" >&2
            echo "equal_verdicts.sh: $preset $lanes: $line (exit code $code)" >&2
            exit 1
        fi
    done
done
if [[ ${#compared[@]} -lt $# ]]; then
    echo "equal_verdicts.sh: a build without a set of lanes; compared: ${compared[*]}" >&2
    exit 1
fi
printf 'lanes: %s:' "$wanted"
printf ' %s,' "${compared[@]}"
printf ' equal (seed %s)\n' "$seed"

rm -rf "$folder"
mkdir -p "$folder"

"$root/build/$1/tests/axg_make_scene" "$machine" "$folder/scene" --poses "$poses" --seed "$seed" \
    --near
# A Jetson's build by day has no workbench; at night its packages bring it.
asked=()
for preset in "$@"; do
    if [[ $preset != *jetson* || -x $root/build/$preset/axguard-lab ]]; then
        asked+=("$preset")
    fi
done
for ask in hit count clearance; do
    for preset in "${asked[@]}"; do
        program_of "$preset" axguard-lab query "$folder/scene" --engine cpu --ask "$ask" \
            --out "$folder/$preset-$ask.csv" >/dev/null
        cmp "$folder/$1-$ask.csv" "$folder/$preset-$ask.csv"
    done
    lines=$(wc -l <"$folder/$1-$ask.csv")
    # A table of the head alone would compare equal as well.
    if [[ $lines -le $poses ]]; then
        echo "equal_verdicts.sh: $folder/$1-$ask.csv has $lines lines, wanted over $poses" >&2
        exit 1
    fi
    echo "$ask: $((lines - 1)) answers equal in ${asked[*]} (seed $seed)"
done

# The same program becomes the same trace, byte for byte, in every build and in a second run.
program=$root/hil_replay/programs/paper-trunnion-demo.ngc
for preset in "$@" "$1"; do
    trace=$folder/$preset.log
    [[ ! -e $trace ]] || trace=$folder/$preset-again.log
    axguard "$preset" simulate "$machine" "$program" -o "$trace" >/dev/null
    cmp "$folder/$1.log" "$trace"
done
echo "simulate: $(wc -l <"$folder/$1.log") frames equal in $*, and in a second run"

# Replayed, the trace gives the same table of verdicts and the same exit code.
for preset in "$@" "$1"; do
    table=$folder/$preset-replay.csv
    [[ ! -e $table ]] || table=$folder/$preset-replay-again.csv
    code=0
    axguard "$preset" replay "$machine" "$folder/$1.log" --mode contact --keep-going \
        --csv "$table" >/dev/null 2>&1 || code=$?
    # 11: a slow build misses the deadline, which is about time; 10 is the collision of the program.
    if [[ $code -ne 10 && $code -ne 11 ]]; then
        echo "equal_verdicts.sh: replay of $preset ended with $code, wanted 10 (collision)" >&2
        exit 1
    fi
    cmp "$folder/$1-replay.csv" "$table"
done
echo "replay: $(($(wc -l <"$folder/$1-replay.csv") - 1)) lines equal in $*, and in a second run"
