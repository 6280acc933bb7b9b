#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# nvcc for this machine and the CUDA runtime for the machine to build for, from PyPI into a folder:
# as little of CUDA as the engine needs, and nothing installed. With the runtime of the other
# architecture in its place nvcc links for that one. A folder that is complete stays as it is.
# Example: toolchains/cuda_toolkit.sh aarch64   into build/cuda-aarch64, for the presets of a Jetson
#          toolchains/cuda_toolkit.sh x86_64    into build/cuda-x86_64, where no nvcc is installed
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
version=$(sed -n 's/^nvidia-cuda-runtime==\([0-9.]*\).*/\1/p' "$root/toolchains/cuda_runtime.txt")
architecture=${1:-$(uname -m)}
case $architecture in
    aarch64 | x86_64) ;;
    *) sed -n '3,7p' "$0" >&2; exit 2 ;;
esac
target=$root/build/cuda-$architecture
if [[ -f $target/version.txt && $(cat "$target/version.txt") == "$version" ]]; then
    exit 0
fi
mkdir -p "$root/build"
fresh=$(mktemp -d "$target.XXXXXX")
trap 'rm -rf "$fresh"' EXIT
fetch() { # ARCHITECTURE LIST FOLDER: into a folder of its own, for pip replaces what it finds
    local platform=$1
    python3 -m pip install -q --disable-pip-version-check --no-deps --only-binary=:all: \
        --require-hashes --no-compile --root-user-action=ignore --target "$fresh/$3" \
        --platform "manylinux2014_$platform" \
        --platform "manylinux_2_17_$platform" --platform "manylinux2010_$platform" \
        --platform "manylinux_2_12_$platform" -r "$root/toolchains/$2"
}
fetch "$(uname -m)" cuda_compiler.txt compiler
fetch "$architecture" cuda_runtime.txt runtime
cuda=$fresh/toolkit
mkdir "$cuda"
for package in "$fresh"/compiler "$fresh"/runtime; do
    cp -r "$package/nvidia/cu13/." "$cuda/"
done
if [[ ! -x $cuda/bin/nvcc || ! -f $cuda/lib/libcudart_static.a ]]; then
    echo "cuda_toolkit.sh: nvcc or the static runtime is missing in the $version of PyPI" >&2
    exit 1
fi
ln -s lib "$cuda/lib64"  # where nvcc looks
ln -s libcudart.so.13 "$cuda/lib/libcudart.so"  # what CMake asks for before it takes the static one
echo "$version" >"$cuda/version.txt"
rm -rf "$target"
mv "$cuda" "$target"
echo "cuda_toolkit.sh: $target: CUDA $version, $(du -sh "$target" | cut -f 1)"
