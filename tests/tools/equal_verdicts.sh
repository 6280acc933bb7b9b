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

# each COMMAND PRESET...: for all builds at once. A failure of one is one of all.
each() {
    local command=$1 pid pids=() failed=0
    shift
    for preset in "$@"; do
        "$command" "$preset" &
        pids+=($!)
    done
    for pid in "${pids[@]}"; do
        wait "$pid" || failed=1
    done
    return "$failed"
}

rm -rf "$folder"
mkdir -p "$folder"

# Hashes over every bit of the answers to random questions, and of the certified test.
hash_lanes() { # PRESET: a line for each set of lanes of this processor
    local code lanes line
    for lanes in avx512 avx2 neon; do
        code=0
        line=$(program_of "$1" tests/axg_lane_hash 3000 "$seed" "$lanes") || code=$?
        [[ $code -eq 77 ]] || echo "$code $lanes $line" >>"$folder/$1-lanes"
    done
}
each hash_lanes "$@"
wanted='' compared=()
for preset in "$@"; do
    if [[ ! -s $folder/$preset-lanes ]]; then
        echo "equal_verdicts.sh: $preset: no set of lanes runs on this processor" >&2
        exit 1
    fi
    while read -r code lanes line; do
        compared+=("$preset $lanes")
        if [[ $code -ne 0 || $line != "${wanted:=$line}" ]]; then
            echo "equal_verdicts.sh: ${compared[0]}: $wanted" >&2
            echo "equal_verdicts.sh: $preset $lanes: $line (exit code $code)" >&2
            exit 1
        fi
    done <"$folder/$preset-lanes"
done
printf 'lanes: %s:' "$wanted"
printf ' %s,' "${compared[@]}"
printf ' equal (seed %s)\n' "$seed"

"$root/build/$1/tests/axg_make_scene" "$machine" "$folder/scene" --poses "$poses" --seed "$seed" \
    --near
# A Jetson's build by day has no workbench; at night its packages bring it.
asked=()
for preset in "$@"; do
    if [[ $preset != *jetson* || -x $root/build/$preset/axguard-lab ]]; then
        asked+=("$preset")
    fi
done
query_scene() { # PRESET
    local ask
    for ask in hit count clearance; do
        program_of "$1" axguard-lab query "$folder/scene" --engine cpu --ask "$ask" \
            --output "$folder/$1-$ask.csv" >/dev/null
    done
}
each query_scene "${asked[@]}"
for ask in hit count clearance; do
    for preset in "${asked[@]}"; do
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
program=$root/hil_replay/programs/${AXG_VERDICT_PROGRAM:-paper-trunnion-demo}.ngc
simulate_program() { # PRESET [SUFFIX]
    axguard "$1" simulate "$machine" "$program" -o "$folder/$1${2:-}.log" >/dev/null
}
each simulate_program "$@"
simulate_program "$1" -again
for trace in "$@" "$1-again"; do
    cmp "$folder/$1.log" "$folder/$trace.log"
done
echo "simulate: $(wc -l <"$folder/$1.log") frames equal in $*, and in a second run"

# Replayed, the trace gives the same table of verdicts and the same exit code.
replay_trace() { # PRESET [SUFFIX]
    local code=0
    axguard "$1" replay "$machine" "$folder/$first.log" --mode contact --keep-going \
        --csv "$folder/$1-replay${2:-}.csv" >/dev/null 2>&1 || code=$?
    # 11: a slow build misses the deadline, which is about time; 10 is a collision, 0 none.
    if [[ $code -ne 0 && $code -ne 10 && $code -ne 11 ]]; then
        echo "equal_verdicts.sh: replay of $1 ended with $code, wanted 0, 10 or 11" >&2
        exit 1
    fi
}
first=$1
each replay_trace "$@"
replay_trace "$1" -again
for table in "${@/%/-replay}" "$1-replay-again"; do
    cmp "$folder/$1-replay.csv" "$folder/$table.csv"
done
echo "replay: $(($(wc -l <"$folder/$1-replay.csv") - 1)) lines equal in $*, and in a second run"
