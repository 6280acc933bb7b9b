#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clang-tidy over every room and program, with the flags of a clang build of them; by day without
# the analyzer but in core, where it is decided. The tests are left out: their macros take the
# analyzer half a minute a file.
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
text=(config firmware_if hil_replay)
code=0
tidy '' '*.cpp' ':!tests/' ':!cuda/' "${text[@]/#/:!}" || code=1
tidy "$([[ ${2:-} == --night ]] || echo '-clang-analyzer-*')" "${text[@]/%//*.cpp}" || code=1
exit $code
