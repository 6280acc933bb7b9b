#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clang-tidy over every room and program, with the flags of a clang build of them. The tests
# are left out: their macros take the analyzer half a minute a file.
# Example: tests/tools/tidy.sh host-clang
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
preset=${1:?usage: tidy.sh PRESET (configured before: cmake --preset PRESET)}
database=$root/build/$preset
if [[ ! -f $database/compile_commands.json ]]; then
    echo "tidy.sh: no $database/compile_commands.json: run cmake --preset $preset" >&2
    exit 2
fi
cd "$root"
mapfile -t files < <(git ls-files '*.cpp' ':!tests/' ':!cuda/')
printf '%s\0' "${files[@]}" |
    xargs -0 -n 1 -P "${AXG_JOBS:-$(nproc)}" clang-tidy-14 --quiet -p "$database"
