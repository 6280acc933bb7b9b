#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Do the packages build from the release tarball alone? A new Debian in a folder, without git or
# CUDA; apt installs what debian/control names, dpkg-buildpackage makes the packages. They are
# copied to OUT/packages, which fresh_packages.sh then tries. Needs root, debootstrap and the
# network.
# Example: sudo tests/fresh/fresh_source.sh build/bookworm
#          ... --release trixie        in Debian 13 instead of 12
#          ... --compare BUILD         BUILD/packages, of a checkout, must have the same files
#          ... --cache DIR             a ccache of this machine: for its compilers, its objects
#          ... --root DIR --keep       in DIR, which stays
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

place='' keep=no out='' compare='' cache='' release=bookworm
while [[ $# -gt 0 ]]; do
    case $1 in
        --root) place=${2:?--root needs a folder}; shift ;;
        --release) release=${2:?--release needs a name}; shift ;;
        --compare) compare=${2:?--compare needs a folder}; shift ;;
        --cache) cache=${2:?--cache needs a folder}; shift ;;
        --keep) keep=yes ;;
        -*) sed -n '3,12p' "$0" >&2; exit 2 ;;
        *) out=$1 ;;
    esac
    shift
done
if [[ -z $out ]]; then
    sed -n '3,12p' "$0" >&2
    exit 2
fi
# shellcheck disable=SC2034 # the sourced file reads it
include=ca-certificates
# shellcheck source=tests/fresh/debian_root.sh
source "$root/tests/fresh/debian_root.sh"
"$root/toolchains/make_tarball.sh" "$place/opt" >>"$log"
timed 'apt-get update' inside 'apt-get update -q'
timed 'unpack' inside 'cd /opt && tar -xf axguard_*.orig.tar.gz && mv axguard-* axguard'
timed 'apt-get build-dep' inside \
    'cd /opt && apt-get build-dep -yq --no-install-recommends ./axguard && ! command -v git nvcc'
launcher=''
if [[ -n $cache ]]; then
    timed 'apt-get install ccache' inside 'apt-get install -yq --no-install-recommends ccache'
    mkdir -p "$cache" "$place/opt/ccache"
    mount --bind "$cache" "$place/opt/ccache" && mounted+=("$place/opt/ccache")
    launcher='export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_DIR=/opt/ccache CCACHE_NOHASHDIR=1
        export CCACHE_BASEDIR=/opt/axguard CCACHE_SLOPPINESS=pch_defines,time_macros'
fi
timed 'dpkg-buildpackage' inside "$launcher
    cd /opt/axguard && dpkg-buildpackage --build=binary --unsigned-changes"
rm -rf "$out/packages"
mkdir -p "$out/packages"
cp "$place"/opt/*.deb "$out/packages/"
inside 'c++ --version | head -n 1'

lists() { # FOLDER: the files of every package, without version and time
    local package
    for package in "$1"/*.deb; do
        dpkg-deb -f "$package" Package
        dpkg-deb --fsys-tarfile "$package" | tar -t | sort
    done
}
if [[ -n $compare ]]; then
    lists "$out/packages" >"$out/files.txt"
    timed 'the same files as of a checkout' diff "$out/files.txt" <(lists "$compare/packages")
fi
echo "$(find "$out/packages" -name '*.deb' | wc -l) packages in $out/packages"
