#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Do the packages install where nothing else is, replace those of the version before, and go without
# a trace but configuration? A new Debian in a folder; apt installs the packages with what they
# depend on; the demo runs, a simulated trace is guarded, the example of the C interface is built
# against them, by pkg-config (linked to the library, and with the archive) and by CMake, and says
# of the trace that it stops. Needs root, debootstrap and the network.
# Example: sudo tests/fresh/fresh_packages.sh build/host-package
#          ... --release trixie       in Debian 13 instead of 12
#          ... --before DIR           after the packages in DIR, of the version before
#          ... --root DIR --keep      in DIR, which stays
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

place='' keep=no build='' before='' release=bookworm
while [[ $# -gt 0 ]]; do
    case $1 in
        --root) place=${2:?--root needs a folder}; shift ;;
        --before) before=${2:?--before needs a folder}; shift ;;
        --release) release=${2:?--release needs a name}; shift ;;
        --keep) keep=yes ;;
        -*) sed -n '3,12p' "$0" >&2; exit 2 ;;
        *) build=$1 ;;
    esac
    shift
done
shopt -s nullglob
packages=("$build"/packages/*.deb)
names='axguard axguardd axguard-board-dev axguard-doc axguard-lab libaxguard0 libaxguard-dev'
wanted=7
if [[ ${packages[*]} == *_amd64.deb* ]]; then # debian/control
    names+=' axguard-linuxcnc'
    wanted=8
fi
if [[ ${#packages[@]} -ne $wanted ]]; then
    echo "fresh_packages.sh: ${#packages[@]} packages in $build/packages, wanted $wanted;" \
        "toolchains/build_packages.sh makes them" >&2
    exit 2
fi
# shellcheck disable=SC2034 # the sourced file reads it
include=ca-certificates,systemd
# shellcheck source=tests/fresh/debian_root.sh
source "$root/tests/fresh/debian_root.sh"
install='apt-get install -yq --no-install-recommends'
timed 'apt-get update' inside 'apt-get update -q'
if [[ -n $before ]]; then
    mkdir "$place/opt/before"
    cp "$before"/*.deb "$place/opt/before/"
    timed 'the version before' inside "$install /opt/before/*.deb && axguardd --version"
fi
mkdir "$place/opt/packages"
cp "${packages[@]}" "$place/opt/packages/"
timed 'apt-get install' inside "$install /opt/packages/*.deb"
# Of the names before, none is left; the service is enabled for can0, which has no machine yet.
# shellcheck disable=SC2016 # the field is dpkg's
timed 'what is installed' inside '
    for name in runtime tools dev; do
        ! dpkg-query -W -f="${db:Status-Status}" axguard-$name 2>/dev/null | grep -x installed
    done
    test -L /etc/systemd/system/multi-user.target.wants/axguardd@can0.service
    test -L /etc/systemd/system/sys-subsystem-net-devices-can0.device.wants/axguardd@can0.service
    test -s /etc/axguard/can0.env && axguard check /etc/axguard/sample.yaml'
inside 'axguard --version && axguardd --version'
# The guard's own machine before any compiler is there: what the packages alone can do.
timed 'axguard demo' inside 'cd /opt && axguard demo'
timed 'simulate' inside 'cd /opt && axguard simulate \
    /usr/share/axguard/config/machines/paper-trunnion.yaml \
    /usr/share/axguard/hil_replay/programs/paper-trunnion-demo.ngc -o trace.log'
timed 'a guarded trace' inside 'cd /opt && axguard replay \
    /usr/share/axguard/config/machines/paper-trunnion.yaml trace.log; test $? -eq 10'
timed 'apt-get install of a compiler' inside "$install g++ make cmake pkg-config libyaml-cpp-dev \
    libfmt-dev libmd-dev libmeshoptimizer-dev"

cat >"$place/opt/build_example.sh" <<'END_OF_SCRIPT'
set -euo pipefail
cd /opt
source=/usr/share/doc/libaxguard-dev/examples/guard_a_trace.c
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

# The configuration stays until it is purged.
left="find / -xdev -name '*axguard*' -not -path '/opt/*' -not -path '/var/lib/dpkg/*' \
    -not -path '/var/cache/*' -not -path '/var/log/*'"
timed 'remove' inside "apt-get remove -yq $names && test -s /etc/axguard/can0.env &&
    ! $left -not -path '/etc/*' | grep ."
timed 'purge' inside "dpkg --purge $names && ! $left | grep ."
