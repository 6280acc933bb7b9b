#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Do the packages install where nothing else is? A new Debian 12 in a folder; apt installs the three
# packages with what they depend on; the example of the C interface is built against them, by
# pkg-config (linked to the library, and with the archive) and by CMake, and says of a simulated
# trace that it stops. Needs root, debootstrap and the network.
# Example: sudo tests/fresh/fresh_packages.sh build/host-package
#          ... --root DIR --keep      in DIR, which stays
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

place='' keep=no build=''
while [[ $# -gt 0 ]]; do
    case $1 in
        --root) place=${2:?--root needs a folder}; shift ;;
        --keep) keep=yes ;;
        -*) sed -n '3,9p' "$0" >&2; exit 2 ;;
        *) build=$1 ;;
    esac
    shift
done
shopt -s nullglob
packages=("$build"/packages/*.deb)
if [[ ${#packages[@]} -ne 3 ]]; then
    echo "fresh_packages.sh: ${#packages[@]} packages in $build/packages, wanted 3;" \
        "toolchains/build_packages.sh makes them" >&2
    exit 2
fi
# shellcheck disable=SC2034 # the sourced file reads it
include=ca-certificates
# shellcheck source=tests/fresh/debian_root.sh
source "$root/tests/fresh/debian_root.sh"
mkdir "$place/opt/packages"
cp "${packages[@]}" "$place/opt/packages/"
timed 'apt-get install' inside 'apt-get update -q && apt-get install -yq --no-install-recommends \
    /opt/packages/*.deb'
inside 'axguard --version && axguardd --version'
# The guard's own machine before any compiler is there: what the packages alone can do.
timed 'axguard demo' inside 'cd /opt && axguard demo'
timed 'simulate' inside 'cd /opt && axguard simulate \
    /usr/share/axguard/config/machines/paper-trunnion.yaml \
    /usr/share/axguard/hil_replay/programs/paper-trunnion-demo.ngc -o trace.log'
timed 'apt-get install of a compiler' inside 'apt-get install -yq --no-install-recommends g++ \
    make cmake pkg-config libyaml-cpp-dev libfmt-dev libmd-dev libmeshoptimizer-dev'

cat >"$place/opt/build_example.sh" <<'END_OF_SCRIPT'
set -euo pipefail
cd /opt
source=/usr/share/doc/axguard-dev/example/guard_a_trace.c
gcc -std=c11 -c "$source" $(pkg-config --cflags axguard) -o guard.o
if [[ -e /usr/lib/$(gcc -print-multiarch)/libaxguard.so ]]; then
    gcc guard.o $(pkg-config --libs axguard) -o guard-shared
    mkdir -p project
    cat >project/CMakeLists.txt <<END_OF_PROJECT
cmake_minimum_required(VERSION 3.25)
project(example C CXX)
find_package(axguard 0.1 REQUIRED)
add_executable(guard-cmake $source)
target_link_libraries(guard-cmake axguard::axguard)
END_OF_PROJECT
    cmake -S project -B project/build >/dev/null && cmake --build project/build >/dev/null
    cp project/build/guard-cmake .
fi
gcc guard.o -Wl,-Bstatic -laxguard -Wl,-Bdynamic $(pkg-config --libs --static axguard |
    sed 's/-laxguard//') -o guard-archive
for program in guard-archive guard-shared guard-cmake; do
    [[ -x $program ]] || continue # without AXG_SHARED there is the archive alone
    code=0
    ./"$program" /usr/share/axguard/config/machines/paper-trunnion.yaml trace.log \
        >"$program.txt" 2>&1 || code=$?
    echo "$program: $(stat -c %s "$program") bytes, exit code $code: $(tail -n 1 "$program.txt")"
    [[ $code -eq 10 ]] || exit 1 # the collision of the program
    cmp guard-archive.txt "$program.txt"
done
END_OF_SCRIPT
timed 'the example' inside 'bash /opt/build_example.sh'
tail -n 3 "$log"
