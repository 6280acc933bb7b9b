#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Compiles the certified test for the device of the smallest Orin. 77: no CUDA compiler here.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if ! command -v nvcc >/dev/null; then
    echo "skipped: no nvcc on the path; the CUDA toolkit provides it"
    exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
nvcc -std=c++20 --fmad=false -ftz=false -prec-sqrt=true -prec-div=true -arch=sm_87 -I "$root" \
    -Xptxas -v -c "$root/tests/device/certified_header.cu" -o "$work/certified_header.o" \
    2>&1 | tee "$work/report"
if grep -E '[1-9][0-9]* bytes (stack frame|spill)' "$work/report"; then
    echo "local memory or spills in the certified test"
    exit 1
fi
[[ $(grep -c '0 bytes stack frame, 0 bytes spill stores' "$work/report") -eq 2 ]]
