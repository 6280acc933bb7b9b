# shellcheck shell=bash
# SPDX-License-Identifier: Apache-2.0
# A new Debian in a folder, for the scripts beside this: sourced with place (a folder that is not
# there yet, or empty), keep (yes or no), include (packages) and release (bookworm, trixie) set, and
# architecture where it is not this machine's: qemu-aarch64-static then runs every program. Needs
# root, debootstrap and the network; mirror, proxy and certificates are those that apt uses on this
# machine. Gives timed, inside, mounted and log; what was made is removed at the end unless it is
# kept.
: "${keep:?}" "${include:?}" "${release:?}"
architecture=${architecture:-$(dpkg --print-architecture)}
if [[ $(id -u) -ne 0 ]] || ! command -v debootstrap >/dev/null; then
    echo "$(basename "$0"): needs root and debootstrap (apt-get install debootstrap)" >&2
    exit 2
fi
if [[ -n $place && -e $place ]]; then
    echo "$(basename "$0"): $place exists already; name a new folder" >&2
    exit 2
fi
[[ -n $place ]] || place=$(mktemp -d)/debian
log=$place.log
mkdir -p "$place"

mounted=() emulator=''
leave() {
    local code=$? folder
    [[ -z $emulator ]] || echo -1 >"$emulator"
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

# The kernel starts the emulator for programs of arm64, in the new system too, until the end.
formats=/proc/sys/fs/binfmt_misc
if [[ $architecture == arm64 && $(uname -m) != aarch64 && ! -e $formats/qemu-aarch64 ]]; then
    format=/usr/lib/binfmt.d/qemu-aarch64.conf
    if [[ ! -e $format ]]; then
        echo "$(basename "$0"): needs apt-get install qemu-user-static" >&2
        exit 2
    fi
    [[ -e $formats/register ]] || mount -t binfmt_misc binfmt_misc "$formats"
    cat "$format" >"$formats/register"
    emulator=$formats/qemu-aarch64
fi

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

timed debootstrap debootstrap --arch="$architecture" --variant=minbase --include="$include" \
    "$release" "$place" "$mirror"
cp -L /etc/resolv.conf "$place/etc/resolv.conf"
apt-config dump | grep -E '^Acquire::(http|https|ftp|Check|Retries)' \
    >"$place/etc/apt/apt.conf.d/99-host" || true
if [[ -d /usr/local/share/ca-certificates ]]; then
    cp -rL /usr/local/share/ca-certificates/. "$place/usr/local/share/ca-certificates/"
    inside update-ca-certificates >>"$log" 2>&1
fi
mount -t proc proc "$place/proc" && mounted+=("$place/proc")
