#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Lies in a bundle as build.sh: compiles the CUDA engine, the paper's kernels and their tests from
# the sources beside it, for the GPU at hand, and links them with the static libraries of the
# bundle. Needs nvcc and g++, no network and no package. Replaces bin/.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source=$here/source objects=$(mktemp -d)
trap 'rm -rf "$objects"' EXIT
arch=sm_$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader -i 0 | tr -d .)
cuda=$(dirname "$(dirname "$(readlink -f "$(command -v nvcc)")")")
# As cuda/CMakeLists.txt and CMakeLists.txt have them.
export KERNEL_FLAGS="-std=c++20 -O3 --fmad=false -ftz=false -prec-sqrt=true -prec-div=true
    --expt-relaxed-constexpr -diag-suppress=128 -Xcompiler=-ffp-contract=off -arch=$arch -I$source"
export HOST_FLAGS="-std=c++20 -O3 -DNDEBUG -ffp-contract=off -I$source -isystem $here/include
    -isystem $cuda/include"
export MACHINES="-DAXG_SOURCE_DIR=\"$here/data\"" PROGRAM="-DAXG_PROGRAM=\"$here/bin/axguard\""
export LAB_PROGRAM="-DAXG_LAB_PROGRAM=\"$here/bin/axguard-lab\""
compile() {
    local object
    object=$2/$(basename "$1").o
    # The flags are words on purpose.
    # shellcheck disable=SC2086
    case $1 in
        *.cu) nvcc $KERNEL_FLAGS -c "$1" -o "$object" ;;
        *) g++ $HOST_FLAGS "$MACHINES" "$PROGRAM" "$LAB_PROGRAM" -c "$1" -o "$object" ;;
    esac
}
export -f compile
find "$source/cuda" "$source/tests/gpu" \( -name '*.cu' -o -name '*.cpp' \) ! -name 'absent_*' \
    -print0 | xargs -0 -P "$(nproc)" -I{} bash -c 'compile "$1" "$2"' _ {} "$objects"
mkdir "$objects/tests"
mv "$objects"/*_test.cpp.o "$objects/tests/"
ar rcs "$objects/libcuda_parts.a" "$objects"/*.o
# This machine's compiler has its own C++ library, at least as new.
rm -rf "$here/bin" "$here"/lib/libstdc++.so.6 "$here/lib/libgcc_s.so.1"
mkdir "$here/bin"
link() {
    local program=$1
    shift
    g++ -o "$program" "$@" -Wl,--start-group "$objects/libcuda_parts.a" "$here"/static/*.a \
        -Wl,--end-group "$here"/lib/*.so* "$cuda/lib64/libcudart_static.a" -lpthread -ldl -lrt
}
link "$here/bin/gpu_tests" "$objects"/tests/*.o &
for program in axguard axguard-lab; do
    link "$here/bin/$program" "$here/static/${program}_main.o" &
done
wait
for program in axguard axguard-lab gpu_tests; do
    if [[ ! -x $here/bin/$program ]]; then
        echo "build.sh: $program was not linked; what is missing stands above" >&2
        exit 1
    fi
done
echo "built for $arch: $(ls "$here/bin" | tr '\n' ' ')"
