#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Packs what a GPU machine without network or packages needs: the tests labelled gpu, axguard with
# its example, and every shared library but the C library's own. The CUDA runtime is linked in, so
# the machine needs a driver and nothing else. Beside it the sources of all that has to do with
# CUDA, the headers they need and the rest of the build as static libraries: where there are nvcc
# and g++ (12 or newer), build.sh compiles engine, kernels and tests anew for the GPU at hand.
#   tests/device/make_bundle.sh build/host-release build/gpu-bundle
# There: build/gpu-bundle/run.sh axguard-lab bench --engine cuda; run.sh gpu_tests parity_test
# or run.sh --tests
# or run.sh plan_partition.sh build/gpu-bundle/bin OUT 8
# or run.sh checkers.sh build/gpu-bundle/bin OUT
# or first build/gpu-bundle/build.sh, and then the same.
set -euo pipefail
if [[ $# -ne 2 || ! -x $1/axguard ]]; then
    echo "usage: make_bundle.sh BUILD_FOLDER BUNDLE_FOLDER, after a build of the folder" >&2
    exit 2
fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$1 bundle=$2
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
mkdir -p "$fresh/bin" "$fresh/lib" "$fresh/data/config" "$fresh/data/hil_replay"
cp -r "$root/config/machines" "$fresh/data/config/"
cp -r "$root/hil_replay/programs" "$fresh/data/hil_replay/"
shopt -s nullglob
for program in "$build/axguard" "$build/axguard-lab" "$build"/tests/axg_make_ball_scene \
    "$build"/tests/axg_make_fine_machine "$build"/tests/gpu_tests; do
    strip -o "$fresh/bin/$(basename "$program")" "$program"
done
for program in "$fresh"/bin/*; do
    ldd "$program" | awk '$3 ~ /^\// {print $3}' |
        grep -vE '/(libc|libm|libdl|libpthread|librt)\.so' || true
done | sort -u | xargs -r cp -L -t "$fresh/lib"
cp "$root"/tests/device/{plan_partition,checkers}.sh "$fresh/bin/"
# Sources and headers, as the repository has them; static libraries without the CUDA ones.
mkdir -p "$fresh/include" "$fresh/static"
(cd "$root" && find core cuda firmware_if config hil_replay tests/support tests/gpu \
    -regex '.*\.\(hpp\|inl\|cuh\|h\|cu\)' -o -path 'cuda/*.cpp' -o -path 'tests/gpu/*.cpp') |
    tar -C "$root" -cT - | tar -C "$fresh" -x --one-top-level=source
for package in gtest nlohmann CLI; do
    cp -rL "/usr/include/$package" "$fresh/include/"
done
find "$build" -name 'lib*.a' ! -name 'libaxg_cuda_*.a' ! -name 'libaxg_fault_kernels.a' \
    -exec cp -t "$fresh/static" {} +
cp "$build/hil_replay/commands/CMakeFiles/axguard.dir/main.cpp.o" "$fresh/static/axguard_main.o"
cp "$build/hil_replay/lab/commands/CMakeFiles/axguard-lab.dir/main.cpp.o" \
    "$fresh/static/axguard-lab_main.o"
cp "$(g++ -print-file-name=libgtest.a)" "$fresh/static/"
strip --strip-debug "$fresh"/static/*.a
cp "$root/tests/device/build_bundle.sh" "$fresh/build.sh"
cat > "$fresh/run.sh" <<'END'
#!/usr/bin/env bash
# Runs one program of this folder, or with --tests each file of tests, one after the other.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
if [[ ${1:-} != --tests ]]; then
    exec "$here/bin/$@"
fi
failed=0
find "$here/source/tests/gpu" -name '*_test.cpp' -printf '%f\n' | sort >"$here/tests.txt"
while read -r file; do
    name=${file%.cpp}
    "$here/bin/gpu_tests" "$name" --gtest_brief=1 </dev/null
    code=$?
    echo "$name: exit code $code"
    [[ $code -eq 0 || $code -eq 77 ]] || failed=1
done <"$here/tests.txt"
exit $failed
END
chmod +x "$fresh/run.sh"
rm -rf "$bundle"
mkdir -p "$(dirname "$bundle")"
mv "$fresh" "$bundle"
chmod 755 "$bundle"
trap - EXIT
du -sh "$bundle" | cut -f1
