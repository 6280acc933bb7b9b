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
if [[ $(id -u) -ne 0 ]] || ! command -v debootstrap >/dev/null; then
    echo "fresh_debian.sh: needs root and debootstrap (apt-get install debootstrap)" >&2
    exit 2
fi
if [[ -n $place && -e $place ]]; then
    echo "fresh_debian.sh: $place exists already; name a new folder" >&2
    exit 2
fi
[[ -n $place ]] || place=$(mktemp -d)/debian
log=$place.log
mkdir -p "$place"

mounted=()
leave() {
    local code=$? folder
    for folder in "${mounted[@]}"; do
        umount --lazy "$folder"
    done
    # Nothing is removed while something of this machine may still be mounted below.
    if [[ $keep == no ]] && ! grep -qF " $place/" /proc/self/mounts; then
        rm -rf --one-file-system "$place"
        [[ $code -ne 0 ]] || rm -f "$log"
    fi
    return "$code"
}
trap leave EXIT

# shellcheck disable=SC2016 # the fields are apt's
mirror=$(apt-get indextargets --format '$(SITE) $(CODENAME) $(COMPONENT)' 2>/dev/null |
    awk '$2 == "bookworm" && $3 == "main" { print $1; exit }')
mirror=${mirror:-http://deb.debian.org/debian}

timed() { # NAME COMMAND...: prints the time; the log's end when it failed
    local name=$1 start=$SECONDS
    shift
    if ! "$@" >>"$log" 2>&1; then
        tail -n 60 "$log" >&2
        echo "FAILED  $name ($((SECONDS - start)) s); all of it: $log" >&2
        exit 1
    fi
    echo "ok      $name ($((SECONDS - start)) s)"
}

inside() { # COMMAND: in the new system, with this machine's proxy settings and nothing else of it
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
        http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" no_proxy="${no_proxy:-}" \
        chroot "$place" bash -c "$1"
}

timed debootstrap debootstrap --variant=minbase --include=git,ca-certificates bookworm "$place" \
    "$mirror"
cp -L /etc/resolv.conf "$place/etc/resolv.conf"
apt-config dump | grep -E '^Acquire::(http|https|ftp|Check|Retries)' \
    >"$place/etc/apt/apt.conf.d/99-host" || true
if [[ -d /usr/local/share/ca-certificates ]]; then
    cp -rL /usr/local/share/ca-certificates/. "$place/usr/local/share/ca-certificates/"
    inside update-ca-certificates >>"$log" 2>&1
fi
mount -t proc proc "$place/proc" && mounted+=("$place/proc")
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
