#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clang-tidy with the flags of a clang build: by day over what has changed since the last --night on
# record and what includes it (changed.py), in the build's units; at night over every source of the
# rooms and programs, with the analyzer. The tests are left out: their macros take the analyzer half
# a minute a file.
# Example: tests/tools/tidy.sh host-clang [--night]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
preset=${1:?usage: tidy.sh PRESET [--night] (configured before: cmake --preset PRESET)}
database=$root/build/$preset/compile_commands.json
if [[ ! -f $database ]]; then
    echo "tidy.sh: no $database: run cmake --preset $preset" >&2
    exit 2
fi
cd "$root"
tidy() { # OPTION...: over the names on standard input
    xargs -r -d '\n' -n 1 -P "${AXG_JOBS:-$(nproc)}" clang-tidy-14 --quiet \
        -p "$(dirname "$database")" "$@"
}
if [[ ${2:-} == --night ]]; then
    git ls-files '*.cpp' ':!tests/' ':!cuda/' | tidy
else
    sources=$(python3 -B tests/tools/changed.py . --sources "$database")
    # A unit includes its sources, which are then judged as its headers are.
    sed '/^$/d' <<<"$sources" | tidy '--checks=-clang-analyzer-*,-bugprone-suspicious-include' \
        '--header-filter=/(core|config|firmware_if|hil_replay)/([a-z0-9_]+/)*[a-z0-9_]+\.[hc]pp$'
fi
