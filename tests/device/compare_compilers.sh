#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Do clang 19 with CUDA 12.6 and nvcc of CUDA 13 give kernels that answer alike, bit for bit? Makes
# a folder with axg_kernel_answers twice: as the build has it, by nvcc, and with kernels and
# launches compiled by clang against CUDA 12.6, otherwise from the same static libraries. Both for
# compute capability 9.0. A machine with such a GPU needs a driver, and no compiler: run.sh there.
#   toolchains/jetpack6_toolkit.sh x86_64
#   cmake --preset host-release -DAXG_CUDA_ARCHITECTURES=90-real
#   cmake --build build/host-release --target axg_kernel_answers
#   tests/device/compare_compilers.sh build/host-release build/compilers
# There: build/compilers/run.sh OUT [COUNT]    0: the same bytes; OUT gets all answers
set -euo pipefail
if [[ $# -ne 2 || ! -x $1/tests/axg_kernel_answers ]]; then
    sed -n '3,11p' "$0" >&2
    exit 2
fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$1 bundle=$2
export root cuda=$root/build/cuda12-x86_64
if [[ ! -f $cuda/version.txt ]]; then
    echo "compare_compilers.sh: toolchains/jetpack6_toolkit.sh x86_64 first" >&2
    exit 1
fi
objects=$(mktemp -d)
fresh=$(mktemp -d)
trap 'rm -rf "$objects" "$fresh"' EXIT
compile() { # SOURCE OBJECTS: with the flags of cuda/CMakeLists.txt and toolchains/flags.cmake
    local flags=(-std=c++20 -O3 -DNDEBUG -ffp-contract=off -fno-fast-math "-I$root"
                 -isystem "$cuda/include")
    case $1 in
        *.cu)
            clang++-19 "${flags[@]}" "--cuda-path=$cuda" --cuda-gpu-arch=sm_90 \
                -Wno-unknown-cuda-version -Wno-unknown-attributes -Wno-cuda-compat \
                -c "$1" -o "$2/$(basename "$1").o"
            ;;
        *) g++ "${flags[@]}" -c "$1" -o "$2/$(basename "$1").o" ;;
    esac
}
export -f compile
# shellcheck disable=SC2016 # the words are the inner shell's
find "$root"/cuda/{engine,paper} "$root/tests/device/kernel_answers.cpp" \
    \( -name '*.cu' -o -name '*.cpp' \) ! -name 'absent_*' -print0 |
    xargs -0 -P "$(nproc)" -I{} bash -c 'compile "$1" "$2"' _ {} "$objects"
libraries=()
while IFS= read -r -d '' library; do
    libraries+=("$library")
done < <(find "$build/core" -name 'lib*.a' -print0)
# The machine there has a C++ library of its own, of GCC 11 or newer.
link() { # PROGRAM PART...
    g++ -o "$fresh/$1" -Wl,--start-group "${@:2}" \
        "${libraries[@]}" "$build"/cuda/{engine,paper}/lib*.a -Wl,--end-group -lpthread -ldl -lrt
    strip "$fresh/$1"
}
mkdir "$fresh/lib"
cp "$cuda/lib/libcudart.so.12" "$fresh/lib/"
# Its own objects come before the archives, whose kernels by nvcc so stay outside.
link clang "$objects"/*.o "$fresh/lib/libcudart.so.12"
link nvcc "$build/tests/device/CMakeFiles/axg_kernel_answers.dir/kernel_answers.cpp.o" \
    "$(dirname "$(dirname "$(readlink -f "$(command -v nvcc)")")")/lib64/libcudart_static.a"
cat >"$fresh/run.sh" <<'END'
#!/usr/bin/env bash
# Runs both programs, nvcc's twice, and compares what they write byte for byte.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
out=${1:?OUT} count=${2:-20000}
mkdir -p "$out"
differ=0
for what in engine paper; do
    number=$count
    [[ $what == engine ]] || number=$((count / 100))
    for run in nvcc nvcc-again clang; do
        "$here/${run%-again}" "$what" "$out/$what-$run.txt" "$number" | sed "s/^/$run: /"
        [[ ${PIPESTATUS[0]} -eq 0 ]] || exit 1
    done
    for other in nvcc-again clang; do
        if cmp "$out/$what-nvcc.txt" "$out/$what-$other.txt"; then
            echo "$what: nvcc and $other: equal," \
                "$(wc -lc <"$out/$what-nvcc.txt" | awk '{print $1 " answers, " $2 " bytes"}')"
        else
            differ=1
            echo "$what: nvcc and $other DIFFER in" \
                "$(diff "$out/$what-nvcc.txt" "$out/$what-$other.txt" | grep -c '^>') lines"
        fi
    done
done
sha256sum "$out"/*.txt
exit $differ
END
chmod +x "$fresh/run.sh"
rm -rf "$bundle"
mkdir -p "$(dirname "$bundle")"
mv "$fresh" "$bundle"
chmod 755 "$bundle"
trap 'rm -rf "$objects"' EXIT
du -sh "$bundle" | cut -f1
