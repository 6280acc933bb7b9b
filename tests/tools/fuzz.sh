#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every fuzz target for so many seconds. What it learns stays in build/<preset>/corpus and is
# where the next run starts; a crash leaves its input in build/<preset>/findings. With 0 seconds it
# runs the committed inputs once each: the seeds, and the corpus of earlier runs.
# Example: tests/tools/fuzz.sh host-asan 60
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
preset=${1:?usage: fuzz.sh PRESET SECONDS (built before: target fuzz_targets)}
seconds=${2:?usage: fuzz.sh PRESET SECONDS}
build=$root/build/$preset
shopt -s nullglob
fuzz=$build/tests/fuzzer
if [[ ! -x $fuzz ]]; then
    echo "fuzz.sh: no $fuzz: cmake --build --preset $preset --target fuzz_targets" >&2
    exit 2
fi
mapfile -t targets < <("$fuzz")
limit=(-max_total_time="$seconds")
[[ $seconds -gt 0 ]] || limit=(-runs=0)

one() {
    local name=$1 corpus findings folder seeds=()
    corpus=$build/corpus/$name
    findings=$build/findings
    mkdir -p "$corpus" "$findings"
    # Real files to start from: the examples, and every form of a line in tests/fuzz/seeds.
    for folder in "$root/tests/fuzz/seeds/$name" "$root/tests/fuzz/corpus/$name" \
        "$root/config/machines" "$root/hil_replay/programs"; do
        [[ ! -d $folder ]] || seeds+=("$folder")
    done
    if ! "$fuzz" "$name" "${limit[@]}" -timeout=10 -rss_limit_mb=2048 -max_len=65536 \
        -artifact_prefix="$findings/$name-" -print_final_stats=1 "$corpus" "${seeds[@]}" \
        >"$build/fuzz-$name.log" 2>&1; then
        tail -n 40 "$build/fuzz-$name.log" >&2
        echo "FAILED  fuzz $name: its input is in $findings" >&2
        return 1
    fi
    echo "ok      fuzz $name: $(awk '/number_of_executed_units/ { print $2 }' \
        "$build/fuzz-$name.log") executions"
}

failed=0
running=0
for target in "${targets[@]}"; do
    if [[ $running -ge ${AXG_JOBS:-$(nproc)} ]]; then
        wait -n || failed=1
        running=$((running - 1))
    fi
    one "$target" &
    running=$((running + 1))
done
while [[ $running -gt 0 ]]; do
    wait -n || failed=1
    running=$((running - 1))
done
exit "$failed"
