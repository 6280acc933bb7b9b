#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The release: every file of this commit and nothing else, in a tarball that needs no git. The same
# commit gives the same bytes. dpkg-buildpackage in the unpacked folder makes the packages.
# Example: toolchains/make_tarball.sh          build/axguard_VERSION.orig.tar.gz
#          toolchains/make_tarball.sh FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=${1:-$root/build}
if ! git -C "$root" rev-parse --verify --quiet HEAD >/dev/null; then
    echo "make_tarball.sh: $root is no git checkout; unpack the tarball that it came from" >&2
    exit 1
fi
version=$(git -C "$root" show HEAD:debian/changelog | sed -n '1s/^axguard (\(.*\)-[^-]*) .*/\1/p')
mkdir -p "$out"
tarball=$out/axguard_$version.orig.tar.gz
git -C "$root" archive --format=tar "--prefix=axguard-$version/" HEAD | gzip -n >"$tarball.tmp"
mv "$tarball.tmp" "$tarball"
echo "$tarball"
