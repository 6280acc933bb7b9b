#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Do the packages install where nothing else is, replace those of the version before, and go without
# a trace but configuration? A new Debian in a folder; apt installs the packages with what they
# depend on; the demo runs, a simulated trace is guarded, the example of the C interface is built
# against them, by pkg-config (linked to the library, and with the archive) and by CMake, and says
# of the trace that it stops. Needs root, debootstrap and the network; for packages of arm64 on
# another machine qemu-user-static, which then runs every program.
# Example: sudo tests/fresh/fresh_packages.sh build/host-package
#          ... --release trixie       in Debian 13 instead of 12
#          ... --before DIR           after the packages in DIR, of the version before
#          ... --before lowered       after the same packages with a lower version and other files
#                                     in /etc, of which a person has edited one
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
        -*) sed -n '3,15p' "$0" >&2; exit 2 ;;
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
architecture=$(dpkg --print-architecture)
[[ ${packages[*]} != *_arm64.deb* ]] || architecture=arm64
# shellcheck disable=SC2034 # the sourced file reads it
include=ca-certificates,systemd
# shellcheck source=tests/fresh/debian_root.sh
source "$root/tests/fresh/debian_root.sh"
# What a person edited stays as it is.
install='DEBIAN_FRONTEND=noninteractive apt-get install -yq --no-install-recommends
    -o Dpkg::Options::=--force-confold'
install=${install//$'\n'/}

lowered() { # FOLDER: the packages as those of a version before, with other files in /etc
    local package version tree
    for package in "${packages[@]}"; do
        tree=$(mktemp -d)
        dpkg-deb -R "$package" "$tree"
        version=$(dpkg-deb -f "$package" Version)
        sed -i "/^\(Version\|Depends\):/s/$version/$version~before/" "$tree/DEBIAN/control"
        if [[ -d $tree/etc/axguard ]]; then
            sed -i '1i# Of the version before.' "$tree"/etc/axguard/*
        fi
        dpkg-deb --root-owner-group -b "$tree" "$1"
        rm -r "$tree"
    done
}

runtime_of_board() { # FOLDER: stands for NVIDIA's cuda-cudart-12-6, with the runtime from PyPI
    local tree
    tree=$(mktemp -d)
    mkdir -p "$tree"/{DEBIAN,etc/ld.so.conf.d,usr/local/cuda-12.6/targets/aarch64-linux/lib}
    cp "$root/build/cuda12-aarch64/lib/libcudart.so.12" \
        "$tree/usr/local/cuda-12.6/targets/aarch64-linux/lib/"
    echo /usr/local/cuda-12.6/targets/aarch64-linux/lib >"$tree/etc/ld.so.conf.d/988_cuda-12.conf"
    printf '%s\n' 'Package: cuda-cudart-12-6' 'Version: 12.6' 'Architecture: arm64' \
        'Maintainer: none' 'Description: stands for that of the board' >"$tree/DEBIAN/control"
    printf '#!/bin/sh\nldconfig\n' >"$tree/DEBIAN/postinst"
    chmod -R go=u-w "$tree" && chmod +x "$tree/DEBIAN/postinst"
    dpkg-deb --root-owner-group -b "$tree" "$1"
    rm -r "$tree"
}

timed 'apt-get update' inside 'apt-get update -q'
if dpkg-deb -f "$build"/packages/axguardd_*.deb Depends | grep -q cuda-cudart; then
    mkdir "$place/opt/board"
    runtime_of_board "$place/opt/board" >>"$log"
    timed 'the runtime of the board' inside "$install /opt/board/*.deb"
fi
if [[ -n $before ]]; then
    mkdir "$place/opt/before"
    if [[ $before == lowered ]]; then
        lowered "$place/opt/before" >>"$log"
    else
        cp "$before"/*.deb "$place/opt/before/"
    fi
    timed 'the version before' inside "$install /opt/before/*.deb && axguardd --version"
    # A person edits can0.env, adds a second bus, disables the first, and has a latch. 0.1.0-1 had
    # no package of this name, and its service was not enabled.
    if inside 'dpkg-query -W axguardd' >>"$log" 2>&1; then
        timed 'a person configures' inside 'mkdir -p /var/lib/axguardd &&
            echo AXGUARD_OPTIONS=--bus-cpu 1 >>/etc/axguard/can0.env &&
            echo "# By a person." >/etc/axguard/can1.yaml && touch /var/lib/axguardd/can1.latch &&
            systemctl disable axguardd@can0 && systemctl enable axguardd@can1'
        cp -r "$place/etc/axguard" "$place/opt/configured"
    fi
fi
mkdir "$place/opt/packages"
cp "${packages[@]}" "$place/opt/packages/"
timed 'apt-get install' inside "$install /opt/packages/*.deb"
# Of the names before, none is left. A new service is enabled for can0, which has no machine yet;
# after an upgrade enabled is what was, and the configuration is a person's.
# shellcheck disable=SC2016 # the fields are dpkg's
cat >"$place/opt/installed.sh" <<'END_OF_SCRIPT'
set -euxo pipefail
for name in runtime tools dev; do
    status=$(dpkg-query -W -f='${db:Status-Status}' axguard-$name 2>/dev/null || true)
    [[ $status != installed ]]
done
for package in /opt/packages/*.deb; do
    dpkg-query -W -f='${Version}\n' "$(dpkg-deb -f "$package" Package)" |
        grep -xF "$(dpkg-deb -f "$package" Version)"
done
enabled=can0 disabled=can1
if [[ -d /opt/configured ]]; then
    enabled=can1 disabled=can0
    for name in can0.env can1.yaml; do
        cmp /opt/configured/$name /etc/axguard/$name
    done
    test -f /var/lib/axguardd/can1.latch
    rm -f /etc/axguard/can0.env.dpkg-dist
fi
cd /etc/systemd/system
for wants in multi-user.target sys-subsystem-net-devices-$enabled.device; do
    test -L $wants.wants/axguardd@$enabled.service
done
[[ $(find . -name "axguardd@$disabled.service") == '' ]]
# What nobody edited is that of the package.
dpkg --fsys-tarfile /opt/packages/axguardd_*.deb | tar -xO ./etc/axguard/sample.yaml |
    cmp - /etc/axguard/sample.yaml
axguard check /etc/axguard/sample.yaml
for program in axguard axguard-certcheck axguardd axguard-lab; do
    test -s /usr/share/man/man1/$program.1.gz
    $program --version
done
END_OF_SCRIPT
timed 'what is installed' inside 'bash /opt/installed.sh'
inside 'axguard --version && axguardd --version'
# The guard's own machine before any compiler is there: what the packages alone can do.
timed 'axguard demo' inside 'cd /opt && axguard demo'
timed 'simulate' inside 'cd /opt && axguard simulate \
    /usr/share/axguard/config/machines/paper-trunnion.yaml \
    /usr/share/axguard/hil_replay/programs/paper-trunnion-demo.ngc -o trace.log'
# Its page has scripts of others in it, with their licence.
# shellcheck disable=SC2016 # the words are the inner shell's
timed 'a guarded trace' inside 'cd /opt && axguard replay --report page.html \
    /usr/share/axguard/config/machines/paper-trunnion.yaml trace.log; test $? -eq 10 &&
    for words in "three.js authors" "Dan Vanderkam" "Permission is hereby granted"; do
        grep -F "$words" page.html | head -n 1 | grep -q . || exit 1
    done'
# The archive for a Jetson links the libraries, which its Ubuntu does not have in these versions.
libraries='libyaml-cpp-dev libfmt-dev libmd-dev libmeshoptimizer-dev'
[[ $architecture != arm64 ]] || libraries=
timed 'apt-get install of a compiler' inside "$install g++ make cmake pkg-config $libraries"

cat >"$place/opt/build_example.sh" <<'END_OF_SCRIPT'
set -euo pipefail
cd /opt
source=/usr/share/doc/libaxguard-dev/examples/guard_a_trace.c
gcc -std=c11 -c "$source" $(pkg-config --cflags axguard) -o guard.o
if [[ -e /usr/lib/$(gcc -print-multiarch)/libaxguard.so ]]; then
    gcc guard.o $(pkg-config --libs axguard) -o guard-shared
fi
mkdir -p project
cat >project/CMakeLists.txt <<END_OF_PROJECT
cmake_minimum_required(VERSION 3.25)
project(example C CXX)
find_package(axguard 0.1 REQUIRED)
foreach(library axguard static)
  if(TARGET axguard::\${library})
    add_executable(guard-cmake-\${library} $source)
    target_link_libraries(guard-cmake-\${library} axguard::\${library})
  endif()
endforeach()
END_OF_PROJECT
cmake -S project -B project/build >/dev/null && cmake --build project/build >/dev/null
cp project/build/guard-cmake-* .
# The include path is where compilers look anyway: nothing of ours is needed in a command.
[[ $(pkg-config --cflags axguard) =~ ^[[:space:]]*$ ]]
[[ $(grep -h 'C_INCLUDES = .' project/build/CMakeFiles/guard-*/flags.make) == '' ]]
gcc guard.o -Wl,-Bstatic -laxguard -Wl,-Bdynamic $(pkg-config --libs --static axguard |
    sed 's/-laxguard//') -o guard-archive
programs=(guard-archive)
# Without AXG_SHARED there is the archive alone.
for program in guard-shared guard-cmake-axguard guard-cmake-static; do
    [[ ! -x $program ]] || programs+=("$program")
done
declare -A running
for program in "${programs[@]}"; do # side by side: under an emulator each takes minutes
    ./"$program" /usr/share/axguard/config/machines/paper-trunnion.yaml trace.log \
        >"$program.txt" 2>&1 &
    running[$program]=$!
done
for program in "${programs[@]}"; do
    code=0
    wait "${running[$program]}" || code=$?
    echo "$program: $(stat -c %s "$program") bytes, exit code $code: $(tail -n 1 "$program.txt")"
    [[ $code -eq 10 ]] || exit 1 # the collision of the program
    cmp guard-archive.txt "$program.txt"
done
END_OF_SCRIPT
timed 'the example' inside 'bash /opt/build_example.sh'
grep '^guard-' "$log" | tail -n 4

# The configuration stays until it is purged.
left="find / -xdev -name '*axguard*' -not -path '/opt/*' -not -path '/var/lib/dpkg/*' \
    -not -path '/var/cache/*' -not -path '/var/log/*'"
state='-not -path /var/lib/axguardd*' # a latch outlives the program, until purge
timed 'remove' inside "apt-get remove -yq $names && test -s /etc/axguard/can0.env &&
    ! $left -not -path '/etc/*' $state | grep ."
own='' # a file that a person made is no package's
if [[ -d $place/opt/configured ]]; then
    own="test \"\$(ls /etc/axguard)\" = can1.yaml && rm -r /etc/axguard &&"
fi
timed 'purge' inside "dpkg --purge $names && $own ! $left | grep ."
