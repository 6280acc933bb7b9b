#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests of stages and of single batches under the four checkers of NVIDIA's toolkit. Each has to
# have run and found nothing: a warning of racecheck is what one lane left to another without a
# barrier, so it counts. What the tests themselves say does not: some want more cases than a checker
# has time for, and a deadline that it does not keep.
#   run.sh checkers.sh BIN_FOLDER OUT_FOLDER
# The raw words are left in OUT_FOLDER. Lines of the sources need kernels compiled with -lineinfo.
set -uo pipefail
if [[ $# -ne 2 || ! -x $1/gpu_tests ]]; then
    echo "usage: checkers.sh BIN_FOLDER OUT_FOLDER; BIN_FOLDER has gpu_tests" >&2
    exit 2
fi
bin=$1 out=$2 failed=0
command -v compute-sanitizer >/dev/null || {
    echo "skipped: needs compute-sanitizer, of the CUDA toolkit"
    exit 77
}
mkdir -p "$out"
export AXG_DEADLINE_US=60000000

check() { # TOOL COUNT TEST [OPTION...]
    local tool=$1 count=$2 name=$3 said clean='ERROR SUMMARY: 0 errors'
    said=$out/$tool-$name.txt
    shift 3
    [[ $tool != racecheck ]] || clean='RACECHECK SUMMARY: 0 hazards'
    AXG_COUNT=$count compute-sanitizer --tool "$tool" --print-limit 1000 "$bin/gpu_tests" "$name" \
        "$@" >"$said" 2>&1
    if grep -q "$clean" "$said" && grep -qE '^\[ +(OK|FAILED) +\]' "$said"; then
        echo "ok      $tool $name"
        return
    fi
    echo "failed  $tool $name: $(grep 'SUMMARY' "$said" || echo "no summary"), $said"
    # Where, how often: without thread, block and address.
    grep -E 'access at|(Write|Read) of|in .*\(' "$said" |
        sed -E 's/0x[0-9a-f]+//g; s/\([0-9]+,[0-9]+,[0-9]+\)//g; s/^=+ *//' |
        sort | uniq -c | sort -rn | head -20
    failed=1
}

for tool in memcheck racecheck initcheck synccheck; do
    check "$tool" 6 certificate_test --gtest_filter='*TwoStages*:*ShortLists*'
    check "$tool" 1 group_test
    check "$tool" 600 parity_test
done
exit $failed
