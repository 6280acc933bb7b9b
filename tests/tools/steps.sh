# shellcheck shell=bash
# SPDX-License-Identifier: Apache-2.0
# Shared by demo.sh and test.sh: runs a step silently, shows its log only when it fails.

steps_begin() { # ROOT [TABLE]: where each step's seconds go (tests/tools/step_table.py)
    steps_root=$1
    steps_failed=0
    steps_logs=$steps_root/build/logs
    steps_table=${2:-/dev/null}
    mkdir -p "$steps_logs"
    [[ $steps_table == /dev/null ]] || : >"$steps_table"
    # A compiler cache only where there is one; a launcher that the user chose stays.
    if [[ -z ${CMAKE_CXX_COMPILER_LAUNCHER:-} ]] && command -v ccache >/dev/null; then
        export CMAKE_CXX_COMPILER_LAUNCHER=ccache
        # It keeps what was compiled with a precompiled header only if told that this is wanted.
        export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
    fi
}

# step NAME COMMAND...: one line when it passed, the end of its log when it failed. Returns its
# status as 0 or 1, so that a caller may leave out what depends on it.
step() {
    local name=$1 log start=$SECONDS
    shift
    log=$steps_logs/${name// /-}.log
    local code=0
    "$@" >"$log" 2>&1 || code=$?
    steps_note "$name" "$((SECONDS - start))"
    if [[ $code -eq 0 ]]; then
        printf 'ok      %s (%d s)\n' "$name" "$((SECONDS - start))"
        return 0
    fi
    steps_failed=$((steps_failed + 1))
    {
        printf 'FAILED  %s (%d s): the end of %s:\n' "$name" "$((SECONDS - start))" "$log"
        tail -n 60 "$log"
    } >&2
    return 1
}

steps_note() { # NAME SECONDS
    printf '%d,%s\n' "$2" "$1" >>"$steps_table"
}

steps_end() {
    if [[ $steps_failed -gt 0 ]]; then
        echo "$steps_failed step(s) failed; logs are in $steps_logs" >&2
        return 1
    fi
}

configure_preset() { # PRESET [OPTION...]
    local preset=$1
    shift
    local options=("$@")
    [[ -z ${AXG_SHARED_DATA:-} ]] || options+=("-DAXG_SHARED_DATA=$AXG_SHARED_DATA")
    (cd "$steps_root" && cmake --preset "$preset" "${options[@]}")
}

build_preset() { # PRESET [TARGET...]
    local preset=$1 targets=()
    shift
    [[ $# -eq 0 ]] || targets=(--target "$@")
    (cd "$steps_root" &&
        cmake --build --preset "$preset" -j "${AXG_JOBS:-$(nproc)}" "${targets[@]}")
}
