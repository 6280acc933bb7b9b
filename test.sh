#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Packages, build, tests. The last line is always "N passed, N failed, N skipped".
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

usage() {
    cat <<'END'
Example: ./test.sh          the release build and its tests, some minutes on two cores
         ./test.sh --all    all that CI runs: also sanitizers, a Jetson's build under an
                            emulator, equal verdicts of all builds, exact oracle, model
                            check, fuzzing, static checks; 30 to 60 minutes
         ./test.sh --night  --all, and what takes longest: all tests with sanitizers, those
                            labelled night, the clang build, ten minutes of each fuzz target;
                            about four hours
Environment: AXG_SHARED_DATA   folder of real machines and logs for the tests labelled data
             AXG_REQUIRE_DATA  1 (or CI=true): a skipped data (--all: or oracle, vm,
                              model, browser, emulated or machine) test is a failure
             AXG_FUZZ_SECONDS  how long each fuzz target runs [default: --all 8, --night 600]
             AXG_JOBS          compilers and tests at once (default: the number of cores)
END
}

all=no night=no
for argument in "$@"; do
    case $argument in
        --all) all=yes ;;
        --night) all=yes night=yes ;;
        -h | --help) usage; exit 0 ;;
        *) echo "test.sh: unknown argument '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done

# shellcheck source=tests/tools/steps.sh
source "$root/tests/tools/steps.sh"
steps_begin "$root"
jobs=${AXG_JOBS:-$(nproc)}
results=$steps_root/build/results
rm -rf "$results"
mkdir -p "$results"
require=()
if [[ ${CI:-} == true || ${AXG_REQUIRE_DATA:-} == 1 ]]; then
    # Without --all neither the oracle's library nor the model checker is installed: those tests
    # may be skipped.
    require=(--require data)
    [[ $all == no ]] || require=(--require "data,oracle,model,vm,browser,emulated,machine")
fi

# Whatever happens, the last line is the count, and the exit code agrees with it.
summary() {
    local code=$?
    trap - EXIT
    [[ $code -eq 0 || $steps_failed -gt 0 ]] || steps_failed=1
    if ! command -v python3 >/dev/null; then # setup.sh did not get that far
        echo "0 passed, 1 failed, 0 skipped"
        return 1
    fi
    python3 "$root/tests/tools/ctest_summary.py" "${require[@]}" --failed-steps "$steps_failed" \
        "$results"
}
trap 'summary; exit $?' EXIT

run_ctest() { # PRESET [CTEST OPTION...]
    local preset=$1
    shift
    ctest --test-dir "$root/build/$preset" --show-only=json-v1 >"$results/$preset.json"
    ctest --test-dir "$root/build/$preset" -j "$jobs" --output-on-failure --no-tests=error \
        --output-junit "$results/$preset.xml" "$@"
}

check_preset() { # PRESET LABELS_LEFT_OUT [CMAKE OPTION...]
    local preset=$1 without=$2
    shift 2
    step "$preset configure" configure_preset "$preset" $tests "$@" || return 0
    step "$preset build" build_preset "$preset" || return 0
    check_tests "$preset" -LE "^($without)$"
}

check_labels() { # PRESET "TARGET..." LABEL...: these, the programs, and of the tests these alone
    local preset=$1 targets labels
    read -ra targets <<<"axguard axguardd $2"
    shift 2
    step "$preset configure" configure_preset "$preset" -DAXG_WERROR=ON $rooms $tests || return 0
    step "$preset build" build_preset "$preset" "${targets[@]}" "${@/%/_tests}" || return 0
    labels=$(IFS='|' && echo "$*")
    check_tests "$preset" -L "^($labels)$" -LE "^(timing|slow|long|night)$"
}

check_tests() { # PRESET CTEST_OPTION...
    local preset=$1
    if ! step "$preset tests" run_ctest "$@"; then
        # Failures that ctest's own result file names are counted from there, not once more here.
        if [[ -s $results/$preset.xml ]] &&
            ! python3 "$root/tests/tools/ctest_summary.py" "$results/$preset.xml" >/dev/null; then
            steps_failed=$((steps_failed - 1))
        fi
    fi
}

# What is left out: by day what takes longest, which says little more than the rest does. And at
# night each source is compiled by itself; by day the tests of a folder at once, and a room at once
# where the build is not shipped.
day='|night' rooms=-DAXG_UNITY=ON tests=-DAXG_UNITY_TESTS=ON
[[ $night == no ]] || day='' rooms=-DAXG_UNITY=OFF tests=-DAXG_UNITY_TESTS=OFF

if [[ $all == no ]]; then
    "$root/setup.sh"
    check_preset host-release "timing|slow|peer|night" -DAXG_CUDA=ON
    exit 0
fi

"$root/setup.sh" --all
# Not in Debian: without a network its test is skipped.
step "cantools from PyPI" python3 -m pip install -q --disable-pip-version-check --upgrade \
    --require-hashes --only-binary=:all: --target "$root/build/python" \
    -r "$root/tests/oracle/requirements.txt" || steps_failed=$((steps_failed - 1))
# Kernels for one device: what they take of others is measured by device.kernel_budget, which
# compiles them, and jetson-thor runs its packages through all checks.
check_preset host-release "timing$day" -DAXG_WERROR=ON -DAXG_BENCHMARKS=ON -DAXG_CUDA=ON \
    -DAXG_CUDA_ARCHITECTURES=90-real
# clang's code: by day the sanitizers' build, of libraries, programs, fuzz targets and unit tests.
# What tries thousands of cases, or runs a whole program, takes minutes there.
builds=(host-release host-asan)
if [[ $night == yes ]]; then
    check_preset host-clang 'timing|oracle|peer|style|browser|model' -DAXG_WERROR=ON
    builds+=(host-clang)
    # It has the assertions of host-debug too.
    check_preset host-asan "timing|slow|oracle|peer|style|model|noalloc|browser" -DAXG_WERROR=ON
else
    step "host-clang configure" configure_preset host-clang -DAXG_WERROR=ON # what clang-tidy reads
    check_labels host-asan "axguard-lab fuzz_targets axg_lane_hash" unit parity
fi
# A Jetson's build, run under emulators; at night with its workbench, and packed. Its libraries come
# from Debian and PyPI: where there is no network, there is no such build.
if step "sysroot" "$root/toolchains/sysroot.sh" &&
    step "guest" "$root/toolchains/sysroot.sh" --guest &&
    step "CUDA for aarch64" "$root/toolchains/cuda_toolkit.sh" aarch64; then
    check_labels jetson-thor "" emulated machine
    if [[ $night == yes ]]; then
        step "jetson-thor packages" "$root/toolchains/build_packages.sh" jetson-thor || true
    fi
    builds+=(jetson-thor)
elif [[ ${#require[@]} -eq 0 ]]; then
    steps_failed=$((steps_failed - 1))
fi
[[ $night == yes ]] || export AXG_VERDICT_POSES=${AXG_VERDICT_POSES:-100}
step "equal verdicts of all builds" "$root/tests/tools/equal_verdicts.sh" "${builds[@]}" || true
fuzz_seconds=8 tidy=()
if [[ $night == yes ]]; then
    fuzz_seconds=600 tidy=(--night)
fi
step "clang-tidy" "$root/tests/tools/tidy.sh" host-clang "${tidy[@]}" || true
step "fuzz" "$root/tests/tools/fuzz.sh" host-asan "${AXG_FUZZ_SECONDS:-$fuzz_seconds}" || true
exit 0
