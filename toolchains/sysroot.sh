#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The libraries and headers of an arm64 Debian in a folder, to link the guard for a Jetson with.
# Fetched by apt with lists and a state of their own, so that neither root nor a foreign
# architecture on this machine is needed; unpacked, not installed. A folder that is complete, and
# of the same list of packages, stays as it is.
# Example: toolchains/sysroot.sh            into build/sysroot-arm64
#          toolchains/sysroot.sh --guest    into build/guest-arm64: what tests/can_vm runs on, a
#                                           kernel, Python and CAN tools
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
target=$root/build/sysroot-arm64
# What setup.sh installs for this machine, and the C and C++ libraries.
packages=(libc6-dev libstdc++-12-dev libeigen3-dev libyaml-cpp-dev libcli11-dev libfmt-dev
          nlohmann-json3-dev libmd-dev libmeshoptimizer-dev libmicrohttpd-dev zlib1g-dev libgmp-dev
          libgtest-dev librapidcheck-dev)
case ${1:-} in
    '') ;;
    --guest)
        target=$root/build/guest-arm64
        packages=(linux-image-arm64 python3 can-utils iproute2 dash coreutils libstdc++6
                  libgmpxx4ldbl libmeshoptimizer2d libmicrohttpd12)
        ;;
    *) sed -n '3,9p' "$0" >&2; exit 2 ;;
esac

if [[ -f $target/packages.txt && $(head -n 1 "$target/packages.txt") == "${packages[*]}" ]]; then
    exit 0
fi
if ! command -v apt-get >/dev/null || ! command -v dpkg-deb >/dev/null; then
    echo "sysroot.sh: wants apt-get and dpkg-deb. Elsewhere, copy the root of a board with" >&2
    echo "  ${packages[*]}" >&2
    echo "and name the copy by AXG_JETSON_SYSROOT" >&2
    exit 1
fi
mkdir -p "$(dirname "$target")"
fresh=$(mktemp -d "$target.XXXXXX")
trap 'rm -rf "$fresh"' EXIT
mkdir -p "$fresh/apt/lists/partial" "$fresh/apt/archives/partial" "$fresh/tree/usr/lib"
foreign_apt() {
    apt-get -q -o APT::Architecture=arm64 -o APT::Architectures::=arm64 \
        -o Dir::State="$fresh/apt" -o Dir::State::lists="$fresh/apt/lists" \
        -o Dir::State::status=/dev/null -o Dir::Cache="$fresh/apt" \
        -o Dir::Cache::archives="$fresh/apt/archives" -o Debug::NoLocking=1 \
        -o APT::Sandbox::User= "$@" >>"$fresh/log" 2>&1 </dev/null
}
if ! { foreign_apt update && foreign_apt install -y --download-only --no-install-recommends \
    "${packages[@]}"; }; then
    tail -n 20 "$fresh/log" >&2
    echo "sysroot.sh: apt-get failed (above). Is the network up, is this Debian 12?" >&2
    exit 1
fi

# /lib is /usr/lib, as on a Debian that was installed: a linker script names the one for the other.
mkdir "$fresh"/tree/usr/{bin,sbin}
ln -s usr/bin usr/sbin usr/lib "$fresh/tree"
for package in "$fresh"/apt/archives/*.deb; do
    name=$(dpkg-deb -f "$package" Package)
    dpkg-deb --fsys-tarfile "$package" |
        tar -x -v --keep-directory-symlink --no-same-owner -C "$fresh/tree" |
        sed "s|^\./|$name /|" >>"$fresh/tree/files.txt"
done
# Nothing in the folder may lead to this machine's own files.
find "$fresh/tree" -type l -lname '/*' -printf '%p\t%l\n' | while IFS=$'\t' read -r link to; do
    ln -sfr "$fresh/tree$to" "$link"
done
{
    echo "${packages[*]}"
    for package in "$fresh"/apt/archives/*.deb; do
        # shellcheck disable=SC2016 # the format is dpkg's
        dpkg-deb -W --showformat '${Package} ${Version}\n' "$package"
    done
} >"$fresh/tree/packages.txt"
rm -rf "$target"
mv "$fresh/tree" "$target"
chmod 755 "$target"
echo "sysroot.sh: $target: $(tail -n +2 "$target/packages.txt" | wc -l) packages," \
    "$(du -sh "$target" | cut -f 1)"
