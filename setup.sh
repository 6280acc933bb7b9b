#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian packages that building and testing need; only those that are missing. With
# --all, where there is no nvcc, one from PyPI is put into build/.
set -euo pipefail

usage() {
    cat <<'END'
Example: ./setup.sh          packages for ./demo.sh and ./test.sh
         ./setup.sh --all    also those for ./test.sh --all (clang, other collision libraries, ...)
         ./setup.sh --list   print the names and install nothing; with --all, all of them
END
}

base=(git ca-certificates cmake ninja-build g++ python3 libeigen3-dev libyaml-cpp-dev libcli11-dev
      libfmt-dev nlohmann-json3-dev libtinyxml2-dev libgmp-dev libgtest-dev librapidcheck-dev
      libvalijson-dev libmd-dev libmeshoptimizer-dev libmicrohttpd-dev zlib1g-dev libjs-three
      libjs-dygraphs)
# Second compiler, its sanitizers and fuzzer, formatter and linter.
extra=(pkg-config clang-14 libclang-rt-14-dev clang-format-14 clang-tidy-14 ccache)
# Exact oracle, peers of the benchmark, CAN tools whose logs are read and written.
extra+=(libcgal-dev libmpfr-dev libfcl-dev libbullet-dev libode-dev can-utils
        python3-can python3-pip g++-aarch64-linux-gnu qemu-user)

# Makes packages, and tries them; the machine that the CAN tests of a cross build run in.
extra+=(dpkg-dev debhelper lintian file debootstrap qemu-system-arm)

# Makes the reference of the C interface.
extra+=(doxygen)

# Checks and compiles the board's side of the permit as firmware is.
extra+=(cppcheck gcc-arm-none-eabi)

# Draws the figures of axguard-lab chart and of axguard check --plan.
extra+=(python3-matplotlib)

# LinuxCNC: its interpreter judges G-code, its planner moves the machine beside the guard.
extra+=(linuxcnc-uspace linuxcnc-uspace-dev)

# Builds the pages as a site, and spells them.
extra+=(mkdocs codespell)

# A browser without a window, for the page of --report.
extra+=(chromium chromium-driver python3-selenium)

# Model checker; it compiles what it checks with gcc.
extra+=(spin gcc)

# A kernel with CAN that runs as a program, and what the tests on it call.
[[ $(dpkg --print-architecture 2>/dev/null) != amd64 ]] || extra+=(user-mode-linux iproute2)

packages=("${base[@]}")
list=no all=no
for argument in "$@"; do
    case $argument in
        --all) packages=("${base[@]}" "${extra[@]}"); all=yes ;;
        --list) list=yes ;;
        -h | --help) usage; exit 0 ;;
        *) echo "setup.sh: unknown argument '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done
if [[ $list == yes ]]; then
    printf '%s\n' "${packages[@]}"
    exit 0
fi
if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "setup.sh: this is no Debian: apt-get is missing. Install the counterparts of:" >&2
    printf '  %s\n' "${packages[@]}" >&2
    exit 1
fi

missing=()
for package in "${packages[@]}"; do
    # shellcheck disable=SC2016 # the format is dpkg's
    state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $state == installed ]] || missing+=("$package")
done
cuda() { # the compiler of the GPU's part, which can do without
    [[ $all == yes ]] || return 0
    [[ -z $(command -v nvcc) && ! -x /usr/local/cuda/bin/nvcc ]] || return 0
    case $(uname -m) in
        x86_64 | aarch64) ;;
        *) return 0 ;;
    esac
    "$(dirname "${BASH_SOURCE[0]}")/toolchains/cuda_toolkit.sh" ||
        echo "setup.sh: no nvcc: everything but the CUDA engine can be built" >&2
}
if [[ ${#missing[@]} -eq 0 ]]; then
    cuda
    exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
        echo "setup.sh: neither root nor sudo. Have an administrator run:" >&2
        echo "  apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -q \
        -o DPkg::Lock::Timeout=300 "$@" </dev/null >"$log" 2>&1
}
echo "setup.sh: installing ${missing[*]}"
# The package lists may be old or absent: fetch them when the first try fails, and try once more.
if ! apt install --no-install-recommends "${missing[@]}"; then
    if ! { apt update && apt install --no-install-recommends "${missing[@]}"; }; then
        tail -n 30 "$log" >&2
        echo "setup.sh: apt-get failed (above). Is the network up, is this Debian 12?" >&2
        exit 1
    fi
fi
cuda
