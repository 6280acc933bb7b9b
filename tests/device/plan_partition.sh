#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Plans the fine machine on a part of the GPU at hand, and replays its program on the model that
# was chosen; the CPU beside it. Shorter lists of a cycle, then two stages, are tried until the
# longest cycle fits.
#   tests/device/plan_partition.sh BIN OUT [SMS]
# BIN holds axguard and axg_make_fine_machine; OUT gets what they print. SMS: 8 unless stated.
set -uo pipefail
if [[ $# -lt 2 || ! -x $1/axguard || ! -x $1/axg_make_fine_machine ]]; then
    echo "usage: plan_partition.sh BIN OUT [SMS]" >&2
    exit 2
fi
bin=$1 out=$2 sms=${3:-8}
fine=$(mktemp -d)
trap 'rm -rf "$fine"' EXIT
mkdir -p "$out"
"$bin/axg_make_fine_machine" "$fine" || exit 1
"$bin/axguard" simulate "$fine/machine.yaml" "$fine/near.ngc" -o "$fine/near.log" || exit 1

# Writes machine file $1 with the further lines $2.
write_machine() {
    { cat "$fine/machine.yaml" && echo "$2"; } > "$fine/$1"
}
# Plans machine file $1 into folder $2, with further options.
plan() {
    local machine=$1 to=$out/$2
    shift 2
    echo "== check $machine --plan $*"
    (time "$bin/axguard" check "$fine/$machine" --plan --positions 200 --passes 2 --output "$to" \
        --json="$to.json" "$@") > "$to.txt" 2>&1
    local code=$?
    sed -n '/multiprocessors/p; /^plan:/,$p' "$to.txt"
    echo "exit code $code"
    return $code
}
# Replays near.log over machine file $1 in mode $2 on engine $3 into $4.
replay() {
    echo "== replay $1 --mode $2 --engine $3"
    local partition=()
    [[ $3 = cpu ]] || partition=(--sms "$sms")
    "$bin/axguard" replay "$fine/$1" "$fine/near.log" --mode "$2" --engine "$3" "${partition[@]}" \
        --keep-going --details --json="$out/$4.json" > "$out/$4.txt" 2>&1
    echo "exit code $?"
    grep -E 'longest|engine|us a cycle|permit|no stop' "$out/$4.txt" | head -12
}

# The lists of core/machine/cycle_work.hpp, and half of each.
whole='node_pairs: 192, leaf_pairs: 240, box_rows: 3072, triangle_pairs: 1024'
half='node_pairs: 96, leaf_pairs: 120, box_rows: 1536, triangle_pairs: 512'
planned="" cycle=""
for stages in 3 2; do
    for lists in whole half; do
        name=stages$stages-$lists
        cycle="cycle: {stages: $stages, lists: {${!lists}, rechecks: 0}}"
        write_machine "$name.yaml" "$cycle"
        if plan "$name.yaml" "gpu-$name" --engine cuda --sms "$sms"; then
            planned=$name
            break 2
        fi
    done
done
if [[ -z $planned ]]; then
    echo "no plan fits into 1000 us on $sms multiprocessors" >&2
    exit 1
fi
# What it chose, as its own lines say.
words=$out/gpu-$planned.txt
simplify=$(sed -n 's/^    simplify_mm: \([0-9.]*\) .*/\1/p' "$words")
capacities=$(sed -n 's/^    capacities: {\(.*\)} .*/\1/p' "$words")
write_machine planned.yaml "$cycle
${capacities:+capacities: {$capacities\}}"
[[ -z $simplify ]] || sed -i "s/unit: mm}/unit: mm, simplify_mm: $simplify}/" "$fine/planned.yaml"
cp "$fine/planned.yaml" "$out/"
write_machine whole.yaml "$cycle"
for mode in contact stoppable; do
    replay planned.yaml $mode cuda "replay-$mode-planned-gpu"
    replay planned.yaml $mode cpu "replay-$mode-planned-cpu"
    replay whole.yaml $mode cuda "replay-$mode-whole-gpu"
done
plan "$planned.yaml" "cpu-$planned" --engine cpu
exit 0
