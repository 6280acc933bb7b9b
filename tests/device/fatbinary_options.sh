#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What toolchains/fatbinary_of_clang.sh makes of clang 19's options: machine code named as CUDA 13's
# fatbinary wants it, uncompressed, and no code that a driver would compile.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$root/toolchains/fatbinary_of_clang.sh" "$work/fatbinary"
# shellcheck disable=SC2016 # of the program that stands for CUDA 13's
printf '#!/bin/sh\nprintf "%%s\\n" "$@"\n' >"$work/fatbinary13"
chmod +x "$work/fatbinary13"
"$work/fatbinary" -64 --create a.fatbin --image=profile=sm_87,file=a,b.o \
    --image=profile=compute_87,file=c.s >"$work/got"
diff "$work/got" - <<'END'
--compress=false
-64
--create
a.fatbin
--image3=kind=elf,sm=87,file=a,b.o
END
