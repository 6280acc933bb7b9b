#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Does the release tarball have all that a package is made of, without git? Unpacks it, compares its
# files with the commit's, configures host-package and makes there what needs no long compilation:
# the library for boards and the pages, with a git that fails. fresh_source.sh builds all of it.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if ! git -C "$root" rev-parse --verify --quiet HEAD >/dev/null; then
    echo "skipped: $root is no git checkout"
    exit 77
fi
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
tarball=$("$root/toolchains/make_tarball.sh" "$place")
again=$("$root/toolchains/make_tarball.sh" "$place/again")
cmp "$tarball" "$again"
tar -xf "$tarball" -C "$place"
source=$(echo "$place"/axguard-*)
# A symbolic link counts as one file, as in git.
diff <(git -C "$root" -c core.quotePath=off ls-tree -r --name-only HEAD | sort) \
    <(cd "$source" && find . -type f -o -type l | sed 's|^\./||' | sort)

mkdir "$place/bin"
printf '#!/bin/sh\necho "git $*" >>%s\nexit 128\n' "$place/git.txt" >"$place/bin/git"
chmod +x "$place/bin/git"
export PATH=$place/bin:$PATH GIT_CEILING_DIRECTORIES=$place
cd "$source"
cmake --preset host-package -DAXG_TESTS=OFF -DAXG_CUDA=OFF >"$place/log" ||
    { tail -n 20 "$place/log" >&2; exit 1; }
cmake --build build/host-package --target axg_firmware_if_board packaged_pages >"$place/log" ||
    { tail -n 20 "$place/log" >&2; exit 1; }
for component in axguard-board-dev axguard-doc; do
    DESTDIR=$place/$component cmake --install build/host-package --component $component >/dev/null
done
# Of the board's side, each source and header; of the pages, each page.
diff <(cd "$source" && find firmware_if/board -name '*.[ch]' | sort) \
    <(cd "$place/axguard-board-dev/usr/share/axguard/board" && find . -name "*.[ch]" |
        sed -n "s,^./firmware_if/,firmware_if/,p" | sort)
diff <(cd "$source" && find docs -name '*.md' | sort) \
    <(cd "$place/axguard-doc/usr/share/doc/axguard-doc/pages" && find docs -name '*.md' | sort)
python3 -B - <<'END'
import sys
sys.path.insert(0, "toolchains")
import make_sbom
assert make_sbom.source_date().endswith("Z"), make_sbom.source_date()
END
if [[ -s $place/git.txt ]]; then
    echo "git was asked: $(sort -u "$place/git.txt")" >&2
    exit 1
fi
echo "$(basename "$tarball"): $(stat -c %s "$tarball") bytes," \
    "$(find . -path ./build -prune -o -type f -print |
        wc -l) files"
echo "1 passed, 0 failed"
