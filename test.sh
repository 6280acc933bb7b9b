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
                            check, static checks; what is rare only where something that it
                            reaches has changed since a run that left nothing out
         ./test.sh --night [PART...]
                            everything, in all builds: also the longest tests, all mutants,
                            each source compiled by itself, ten minutes of each fuzz target.
                            PART: sanitizers, release, clang, jetson, verdicts, tidy, fuzz or
                            mutants [default: all, some four hours]
Environment: AXG_SHARED_DATA   folder of real machines and logs for the tests labelled data
             AXG_REQUIRE_DATA  1 (or CI=true): a skipped data (--all: or oracle, vm,
                              model, browser, emulated or machine) test is a failure
             AXG_FUZZ_SECONDS  how long each fuzz target runs [default: --all 0, the committed
                              inputs once each; --night 600]
             AXG_CHECKED_COMMIT  what --all compares with; none: it leaves nothing out
                              [default: the last run on record that left nothing out]
             AXG_COUNT_DIVISOR  of the usual number of random cases [default: 3; --night 1]
             AXG_JOBS          compilers and tests at once (default: the number of cores)
END
}

all=no night=no parts=()
for argument in "$@"; do
    case $argument in
        --all) all=yes ;;
        --night) all=yes night=yes ;;
        -h | --help) usage; exit 0 ;;
        sanitizers | release | clang | jetson | verdicts | tidy | fuzz | mutants)
            parts+=("$argument") ;;
        *) echo "test.sh: unknown argument '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done
if [[ ${#parts[@]} -gt 0 && $night == no ]]; then
    echo "test.sh: '${parts[0]}': a part needs --night" >&2
    usage >&2
    exit 2
fi

# shellcheck source=tests/tools/steps.sh
source "$root/tests/tools/steps.sh"
steps_begin "$root" "$root/build/steps.csv"
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
    if [[ $all == yes ]]; then
        python3 -B "$root/tests/tools/step_table.py" "$steps_table" "$root" --kind "$kind" || true
    fi
    # Parts without tests, such as tidy and fuzz: their steps count.
    if [[ ${#parts[@]} -gt 0 && -z $(find "$results" -name '*.xml') ]]; then
        echo "$(($(wc -l <"$steps_table") - steps_failed)) passed, $steps_failed failed, 0 skipped"
        [[ $steps_failed -eq 0 ]]
        return
    fi
    python3 "$root/tests/tools/ctest_summary.py" "${require[@]}" --failed-steps "$steps_failed" \
        "$results"
}
kind=day
[[ $night == no ]] || kind=night
trap 'summary; exit $?' EXIT

is_part() { # NAME: whether it is asked for
    [[ ${#parts[@]} -eq 0 || " ${parts[*]} " == *" $1 "* ]]
}

setup() { # [OPTION]
    local start=$SECONDS
    "$root/setup.sh" "$@"
    steps_note packages $((SECONDS - start))
}

run_ctest() { # PRESET RESULTS [CTEST OPTION...]
    local preset=$1 name=$2 rare=''
    shift 2
    ctest --test-dir "$root/build/$preset" --show-only=json-v1 >"$results/$name.json"
    if [[ $night == no && $all == yes ]]; then
        rare=$(python3 -B "$root/tests/tools/changed.py" "$root" --left-out "$results/$name.json")
        echo "left out, for nothing that they reach has changed: ${rare:-none}"
    fi
    # One more at once than there are cores: a guest waits for half of its time.
    ctest --test-dir "$root/build/$preset" -j $((jobs + 1)) --output-on-failure --no-tests=error \
        --output-junit "$results/$name.xml" ${rare:+-E "$rare"} "$@"
}

# configure PRESET [CMAKE OPTION...]: by day the sources of a room, and the tests of a folder, are
# compiled at once; at night, and in packages, each by itself.
configure() {
    local preset=$1 units=ON
    shift
    [[ $night == no ]] || units=OFF
    step "$preset configure" configure_preset "$preset" -DAXG_UNITY=$units \
        -DAXG_UNITY_TESTS=$units "$@"
}

check_tests() { # PRESET NAME CTEST_OPTION...
    local preset=$1 name=$2 results_file=$results/$1-$2.xml
    shift 2
    if ! step "$preset $name" run_ctest "$preset" "$preset-$name" "$@"; then
        # Failures that ctest's own result file names are counted from there, not once more here.
        if [[ -s $results_file ]] &&
            ! python3 "$root/tests/tools/ctest_summary.py" "$results_file" >/dev/null; then
            steps_failed=$((steps_failed - 1))
        fi
    fi
}

# All of a configured build, and its tests but those so labelled.
builds=()
check_all() { # PRESET LABELS_LEFT_OUT
    step "$1 build" build_preset "$1" || return 0
    builds+=("$1")
    check_tests "$1" tests -LE "^($2)$"
}

# Of a configured build these targets and the programs, and of the tests those so labelled.
check_labels() { # PRESET "TARGET..." LABEL...
    local preset=$1 targets labels
    read -ra targets <<<"axguard axguardd $2"
    shift 2
    step "$preset build" build_preset "$preset" "${targets[@]}" || return 0
    builds+=("$preset")
    labels=$(IFS='|' && echo "$*")
    check_tests "$preset" tests -L "^($labels)$" -LE '^(timing|slow|night|sources)$'
}

# By day a third of the random cases; at night all.
[[ $night == yes ]] || export AXG_COUNT_DIVISOR=${AXG_COUNT_DIVISOR:-3}

if [[ $all == no ]]; then
    setup
    # What a newcomer has to see pass. Kernels take longer to compile than all the rest.
    cuda=-DAXG_CUDA=ON
    [[ -e /dev/nvidiactl || -e /dev/nvhost-gpu || -e /dev/nvgpu ]] || cuda=-DAXG_CUDA=OFF
    configure host-release "$cuda" -DAXG_UNIT_TESTS=all || exit 0
    check_tests host-release sources -L '^sources$'
    kinds=(unit property replay noalloc parity)
    check_labels host-release "axguard-lab guard_a_trace axg_c ${kinds[*]/%/_tests}" "${kinds[@]}" \
        style
    exit 0
fi

setup --all
# Not in Debian: without a network its test is skipped.
step "cantools from PyPI" python3 -m pip install -q --disable-pip-version-check --upgrade \
    --require-hashes --only-binary=:all: --target "$root/build/python" \
    -r "$root/tests/oracle/requirements.txt" || steps_failed=$((steps_failed - 1))

# By day each unit test runs once: with sanitizers, but for those that take minutes there.
short=short long=long
[[ $night == no ]] || short=all long=all
# By day kernels are compiled where a change reaches them or their tests: CI has no GPU to run them.
cuda=ON
[[ $night == yes ]] ||
    python3 -B "$root/tests/tools/changed.py" "$root" --any 'cuda/*' 'tests/gpu/*' || cuda=OFF
# A release build has kernels for one device: what they take of others is measured by
# device.kernel_budget, which compiles them.
configure_release() {
    configure host-release -DAXG_WERROR=ON -DAXG_BENCHMARKS=ON -DAXG_CUDA=$cuda \
        -DAXG_CUDA_ARCHITECTURES=90-real -DAXG_UNIT_TESTS=$long
}

# A Jetson's build, run under emulators; at night with its workbench, and packed. Its libraries come
# from Debian and PyPI: where there is no network, there is no such build.
check_jetson() {
    if step "sysroot" "$root/toolchains/sysroot.sh" &&
        step "guest" "$root/toolchains/sysroot.sh" --guest &&
        step "CUDA for aarch64" "$root/toolchains/cuda_toolkit.sh" aarch64; then
        configure jetson-thor -DAXG_WERROR=ON -DAXG_CUDA=$cuda || return 0
        check_labels jetson-thor "emulated_tests machine_tests" emulated machine
        if [[ $night == yes ]]; then
            step "jetson-thor packages" "$root/toolchains/build_packages.sh" jetson-thor || true
        fi
    elif [[ ${#require[@]} -eq 0 ]]; then
        steps_failed=$((steps_failed - 1))
    fi
}

# The cheapest first: what reads the sources alone, then what the sanitizers see.
if is_part release && configure_release; then
    check_tests host-release sources -L '^sources$'
fi
if is_part sanitizers && configure host-asan -DAXG_WERROR=ON -DAXG_UNIT_TESTS=$short; then
    if [[ $night == yes ]]; then
        check_all host-asan 'timing|slow|oracle|peer|style|model|noalloc|browser'
    else
        check_labels host-asan "axguard-lab axg_lane_hash fuzz_targets unit_tests" unit
    fi
fi
if is_part fuzz && [[ -d $root/build/host-asan ]]; then
    seconds=0
    [[ $night == no ]] || seconds=600
    step "fuzz" "$root/tests/tools/fuzz.sh" host-asan "${AXG_FUZZ_SECONDS:-$seconds}" || true
fi
if is_part release; then
    left_out='timing|sources|mutants'
    [[ $night == yes ]] || left_out+='|night'
    check_all host-release "$left_out"
fi
# What clang-tidy reads; at night it is built, and runs the tests, too.
if is_part clang || is_part tidy; then
    configure host-clang -DAXG_WERROR=ON || true
fi
if is_part clang && [[ $night == yes ]]; then
    check_all host-clang 'timing|oracle|peer|style|browser|model'
fi
if is_part jetson; then
    check_jetson
fi
if is_part verdicts; then
    if [[ ${#builds[@]} -lt 2 ]]; then # it is asked for alone: builds of an earlier run
        builds=(host-release host-asan host-clang jetson-thor)
    fi
    # The release build makes the scene; what is not built is left out.
    compared=()
    for preset in host-release host-asan host-clang jetson-thor; do
        [[ " ${builds[*]} " != *" $preset "* || ! -x $root/build/$preset/axguard ]] ||
            compared+=("$preset")
    done
    # By day fewer poses, and the shorter of two programs: under the emulator it takes the time.
    [[ $night == yes ]] || export AXG_VERDICT_POSES=${AXG_VERDICT_POSES:-100} \
        AXG_VERDICT_PROGRAM=${AXG_VERDICT_PROGRAM:-paper-trunnion-near}
    step "equal verdicts of all builds" "$root/tests/tools/equal_verdicts.sh" "${compared[@]}" ||
        true
fi
if is_part tidy; then
    tidy=()
    [[ $night == no ]] || tidy=(--night)
    step "clang-tidy" "$root/tests/tools/tidy.sh" host-clang "${tidy[@]}" || true
fi
if is_part mutants && [[ $night == yes ]]; then
    configure_release && check_tests host-release mutants -L '^mutants$'
fi
exit 0
