#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clang-tidy with the flags of a clang build: by day over the rooms that decide, at night over every
# room and program. The tests are left out: their macros take the analyzer half a minute a file.
# Example: tests/tools/tidy.sh host-clang [--night]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
preset=${1:?usage: tidy.sh PRESET [--night] (configured before: cmake --preset PRESET)}
database=$root/build/$preset
if [[ ! -f $database/compile_commands.json ]]; then
    echo "tidy.sh: no $database/compile_commands.json: run cmake --preset $preset" >&2
    exit 2
fi
cd "$root"
tidy() { # CHECKS PATHSPEC...: these besides those of .clang-tidy
    local checks=$1
    shift
    git ls-files -z "$@" |
        xargs -0 -n 1 -P "${AXG_JOBS:-$(nproc)}" clang-tidy-14 --quiet -p "$database" \
            "--checks=$checks"
}
code=0
if [[ ${2:-} == --night ]]; then
    tidy '' '*.cpp' ':!tests/' ':!cuda/' || code=1
else
    tidy '-clang-analyzer-*' {core/certificate,core/guard,firmware_if/guard}/'*.cpp' || code=1
fi
exit $code
