#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Stands for CUDA 12's fatbinary, which PyPI does not have: clang names its images as that one did,
# and the fatbinary of CUDA 13 wants another form. Machine code only; uncompressed, as a driver of
# JetPack 6 reads it.
# Example: toolchains/fatbinary_of_clang.sh -64 --create a.fatbin --image=profile=sm_87,file=a.o
set -euo pipefail
arguments=()
for argument in "$@"; do
    case $argument in
        --image=profile=sm_*)
            device=${argument#--image=profile=sm_}
            arguments+=("--image3=kind=elf,sm=${device%%,*},file=${device#*,file=}")
            ;;
        --image=profile=compute_*) ;;
        *) arguments+=("$argument") ;;
    esac
done
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/fatbinary13" --compress=false \
    "${arguments[@]}"
