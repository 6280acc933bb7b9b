#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a clone to the packages: both presets of a Jetson, the packages for arm64 and those for this
# machine, each with its list of dependencies, checked (check_packages.py). Prints sizes, what
# kind of files the programs are, and which devices they hold kernels for.
# Example: ./setup.sh --all && toolchains/build_packages.sh
#          toolchains/build_packages.sh jetson-thor      this preset alone; so also jetson-orin-jp6
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
presets=("$@")
[[ $# -gt 0 ]] || presets=(jetson-thor jetson-orin host-package)
for preset in "${presets[@]}"; do
    case $preset in
        jetson-thor | jetson-orin | jetson-orin-jp6 | host-package) ;;
        *) sed -n '3,7p' "$0" >&2; exit 2 ;;
    esac
done
# shellcheck source=tests/tools/steps.sh
source "$root/tests/tools/steps.sh"
steps_begin "$root"
trap 'steps_end' EXIT
if [[ ${presets[*]} == *jetson* ]]; then
    step "sysroot" "$root/toolchains/sysroot.sh"
    step "CUDA for aarch64" "$root/toolchains/cuda_toolkit.sh" aarch64
fi
if [[ ${presets[*]} == *jp6* ]]; then
    step "CUDA 12.6 for aarch64" "$root/toolchains/jetpack6_toolkit.sh"
fi

pack() { # PRESET: debian/rules in a folder of the build, so that the source stays as it is
    local build=$root/build/$1 architecture
    architecture=$(dpkg --print-architecture)
    [[ $1 != *jetson* ]] || architecture=arm64
    rm -rf "$build/packages" "$build/packing"
    mkdir -p "$build/packages" "$build/packing"
    cp -r "$root/debian" "$build/packing/"
    (cd "$build/packing" && AXG_SOURCE=$root AXG_PRESET=$1 AXG_PACKAGES=$build/packages \
        DEB_RULES_REQUIRES_ROOT=no dpkg-architecture -a"$architecture" -f -c debian/rules binary)
}
for preset in "${presets[@]}"; do
    step "$preset configure" configure_preset "$preset" -DAXG_WERROR=ON
    step "$preset build" build_preset "$preset" packaged guard_a_trace
    step "$preset packages" pack "$preset"
    step "$preset check" "$root/toolchains/check_packages.py" "$root/build/$preset"
    cat "$steps_logs/$preset-check.log"
done
