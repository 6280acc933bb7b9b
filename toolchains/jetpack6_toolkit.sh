#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# CUDA 12.6 for clang, from PyPI into build/cuda12-aarch64: ptxas and libdevice for this machine,
# headers and libcudart.so.12 for a Jetson with JetPack 6, and fatbinary of CUDA 13 behind
# fatbinary_of_clang.sh. PyPI has no nvcc of 12.6, so clang 19 compiles, which Debian 12 has; what
# bin/nvcc prints is the version that CMake asks for. A folder that is complete stays as it is.
# Example: toolchains/jetpack6_toolkit.sh           for the preset jetson-orin-jp6
#          toolchains/jetpack6_toolkit.sh x86_64    into build/cuda12-x86_64, to compare compilers
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
version=$(sed -n 's/^nvidia-cuda-nvcc-cu12==\([0-9.]*\).*/\1/p' \
    "$root/toolchains/cuda12_compiler.txt")
architecture=${1:-aarch64}
case $architecture in
    aarch64 | x86_64) ;;
    *) sed -n '3,8p' "$0" >&2; exit 2 ;;
esac
if ! command -v clang++-19 >/dev/null; then
    echo "jetpack6_toolkit.sh: wants clang++-19: apt-get install clang-19 (./setup.sh leaves it" \
        "out: nothing else needs it)" >&2
    exit 1
fi
target=$root/build/cuda12-$architecture
if [[ -f $target/version.txt && $(cat "$target/version.txt") == "$version" ]]; then
    exit 0
fi
"$root/toolchains/cuda_toolkit.sh" "$architecture"
fresh=$(mktemp -d "$target.XXXXXX")
trap 'rm -rf "$fresh"' EXIT
fetch() { # ARCHITECTURE LIST FOLDER
    python3 -m pip install -q --disable-pip-version-check --no-deps --only-binary=:all: \
        --require-hashes --no-compile --root-user-action=ignore --target "$fresh/$3" \
        --platform "manylinux2014_$1" --platform "manylinux1_$1" --platform "manylinux_2_17_$1" \
        -r "$root/toolchains/$2"
}
fetch "$(uname -m)" cuda12_compiler.txt compiler
fetch "$architecture" cuda12_runtime.txt runtime
cuda=$fresh/toolkit
mkdir -p "$cuda/bin" "$cuda/lib"
cp -r "$fresh/compiler/nvidia/cuda_nvcc/include" "$fresh/compiler/nvidia/cuda_nvcc/nvvm" "$cuda/"
cp -r "$fresh/runtime/nvidia/cuda_runtime/include/." "$cuda/include/"
install "$fresh/compiler/nvidia/cuda_nvcc/bin/ptxas" "$cuda/bin/"
install "$root/build/cuda-$architecture/bin/fatbinary" "$cuda/bin/fatbinary13"
install "$root/toolchains/fatbinary_of_clang.sh" "$cuda/bin/fatbinary"
cp "$fresh/runtime/nvidia/cuda_runtime/lib/libcudart.so.12" "$cuda/lib/"
ln -s libcudart.so.12 "$cuda/lib/libcudart.so"
ln -s lib "$cuda/lib64"
# clang includes it before all else, to hide what it declares; nothing here uses cuRAND.
echo '// None: cuRAND is not used.' >"$cuda/include/curand_mtgp32_kernel.h"
printf '#!/bin/sh\necho "Cuda compilation tools, release 12.6, V%s"\n' "$version" >"$cuda/bin/nvcc"
chmod +x "$cuda/bin/nvcc"
echo "$version" >"$cuda/version.txt"
rm -rf "$target"
mv "$cuda" "$target"
echo "jetpack6_toolkit.sh: $target: CUDA $version, $(du -sh "$target" | cut -f 1)"
