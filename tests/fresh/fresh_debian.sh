#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Does it build where nothing but git is installed? A new Debian 12 in a folder, a clone of this
# repository's HEAD, ./demo.sh, ./test.sh, each timed. Needs root, debootstrap and the network.
# The mirror, proxy and certificates are those that apt uses on this machine.
# Example: sudo tests/fresh/fresh_debian.sh                    in a temporary folder, removed after
#          sudo tests/fresh/fresh_debian.sh --root DIR --keep  in DIR, which stays
#          ... --data DIR                                      with the shared data, read-only
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

place='' data='' keep=no
while [[ $# -gt 0 ]]; do
    case $1 in
        --root) place=${2:?--root needs a folder}; shift ;;
        --data) data=${2:?--data needs a folder}; shift ;;
        --keep) keep=yes ;;
        *) sed -n '3,8p' "$0" >&2; exit 2 ;;
    esac
    shift
done
# shellcheck disable=SC2034 # the sourced file reads it
include=git,ca-certificates release=bookworm
# shellcheck source=tests/fresh/debian_root.sh
source "$root/tests/fresh/debian_root.sh"
if [[ -n $data ]]; then
    mkdir -p "$place/root/shared/data"
    mount --bind "$data" "$place/root/shared/data" && mounted+=("$place/root/shared/data")
    mount -o remount,bind,ro "$place/root/shared/data"
fi
git -C "$root" -c safe.directory='*' bundle create --quiet "$place/root/axguard.bundle" HEAD

# From here on, what the README tells a newcomer.
timed 'git clone' inside 'cd && git -c advice.detachedHead=false clone axguard.bundle axguard'
timed './demo.sh' inside 'cd ~/axguard && ./demo.sh'
timed './test.sh' inside 'cd ~/axguard && ./test.sh'
tail -n 1 "$log"
