#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Does clang 19, which compiles for JetPack 6, accept every kernel? Templates are instantiated, no
# code is made. Needs clang++-19 and a folder of jetpack6_toolkit.sh, and no GPU.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cuda=''
for folder in "$root"/build/cuda12-{x86_64,aarch64}; do
    [[ ! -f $folder/version.txt ]] || cuda=$folder
done
if ! command -v clang++-19 >/dev/null || [[ -z $cuda ]]; then
    echo "skipped: needs clang++-19 (apt-get install clang-19), toolchains/jetpack6_toolkit.sh"
    exit 77
fi
# The flags of cuda/CMakeLists.txt, for the device alone.
find "$root/cuda" "$root/tests" -name '*.cu' -print0 | sort -z | xargs -0 -n 1 -P 2 \
    clang++-19 -x cuda -std=c++20 -O3 -ffp-contract=off --cuda-device-only -fsyntax-only \
    "--cuda-path=$cuda" --cuda-gpu-arch=sm_87 -Wno-unknown-cuda-version -Wno-unknown-attributes \
    -Wno-cuda-compat "-I$root" -isystem "$cuda/include"
echo "1 passed, 0 failed"
