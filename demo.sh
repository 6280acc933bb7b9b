#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The main job from nothing: packages, build, a simulated program replayed up to its collision.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
    echo "Example: ./demo.sh    installs packages, builds, runs 'axguard demo'; arguments go to it"
    exit 0
fi
# shellcheck source=tests/tools/steps.sh
source "$root/tests/tools/steps.sh"
steps_begin "$root"
"$root/setup.sh"
# The sources of a room at once, and no kernels where there is no GPU: they take longer to compile
# than all the rest. A build that is there already stays as it is.
options=()
if [[ ! -e $root/build/host-release/CMakeCache.txt ]]; then
    options=(-DAXG_UNITY=ON)
    [[ -e /dev/nvidiactl || -e /dev/nvhost-gpu || -e /dev/nvgpu ]] || options+=(-DAXG_CUDA=OFF)
fi
step configure configure_preset host-release "${options[@]}"
step build build_preset host-release axguard
steps_end || exit 1
exec "$root/build/host-release/axguard" demo "$@"
