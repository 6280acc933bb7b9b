#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every build of the engine and of the certified test answers in equal bits: this build's lane
sets, without optimisation, the other compiler, and AArch64 under qemu. Compares the hashes that
lane_hash prints."""
import concurrent.futures
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
COUNT = os.environ.get("AXG_COUNT", "3000")
SEED = os.environ.get("AXG_SEED", "20")
SOURCES = (
    "core/base/arena.cpp", "core/base/assert.cpp", "core/collision/cpu_engine.cpp",
    "core/collision/tree.cpp", "hil_replay/lab/cases/pair_cases.cpp",
    "hil_replay/lab/cases/pair_shapes.cpp", "tests/parity/lane_hash.cpp")
# As toolchains/flags.cmake and core/collision/CMakeLists.txt have them.
FLAGS = ["-std=c++20", "-ffp-contract=off", "-fno-fast-math", "-fno-exceptions", "-fno-rtti"]
AVX2 = ["-mavx2", "-mfma", "-mbmi2"]
AVX512 = ["-mavx512f", "-mavx512vl", "-mavx512dq", "-mavx512bw", "-mfma", "-mbmi2"]


def run_hash(command, lanes):
    """The line of lane_hash for these lanes; None where they cannot run."""
    run = subprocess.run([*command, COUNT, SEED, lanes], text=True, capture_output=True)
    if run.returncode == SKIPPED:
        return None
    if run.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))} {lanes}: {run.returncode}\n{run.stderr}")
    return run.stdout.strip()


def build(root, folder, compiler, options, kernels):
    """A lane_hash of its own; kernels: {name of traverse_*.cpp: flags}."""
    folder.mkdir()
    cache = [shutil.which("ccache")] if shutil.which("ccache") else []
    units = [(root / name, []) for name in SOURCES]
    units += [(root / f"core/collision/traverse_{name}.cpp", kernels.get(name, []))
              for name in ("avx512", "avx2", "neon")]
    objects = [folder / (source.stem + ".o") for source, _ in units]
    commands = [[*cache, *compiler, *FLAGS, *options, *more, "-I", root, "-c", source, "-o", o]
                for (source, more), o in zip(units, objects)]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda command: subprocess.run(command, check=True), commands))
    program = folder / "lane_hash"
    link = ["-static"] if "aarch64" in compiler[0] else []
    subprocess.run([*compiler, *link, *objects, "-o", program], check=True)
    return program


def main():
    root, native, compiler = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    if not native.exists():
        print(f"skipped: {native.name} is not built")
        sys.exit(SKIPPED)
    hashes, skipped = {}, []

    def note(name, command, lanes):
        line = run_hash(command, lanes)
        if line is None:
            skipped.append(f"{name} {lanes}: not on this processor")
        else:
            hashes[f"{name} {lanes}"] = line

    is_x86 = platform.machine() in ("x86_64", "AMD64")
    lane_sets = ("avx512", "avx2") if is_x86 else ("neon",)
    for lanes in lane_sets:
        note("this build", [native], lanes)
    widest = {"avx2": AVX2, "avx512": AVX512} if is_x86 else {}
    one_set = {"avx2": AVX2} if is_x86 else {}
    builds = [("unoptimised", [compiler], ["-O0"], widest)]
    own = pathlib.Path(compiler).resolve()
    others = [name for name in ("g++", "clang++", "clang++-14")
              if shutil.which(name) and pathlib.Path(shutil.which(name)).resolve() != own]
    if others:
        builds += [(f"{others[0]} -O3", [others[0]], ["-O3"], widest),
                   (f"{others[0]} -O0", [others[0]], ["-O0"], one_set)]
    else:
        skipped.append("other compiler: neither g++ nor clang++ beside this build's")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for number, (name, command, options, kernels) in enumerate(builds):
            program = build(root, folder / str(number), command, options, kernels)
            for lanes in kernels or ("neon",):
                note(name, [program], lanes)
        cross, qemu = "aarch64-linux-gnu-g++", shutil.which("qemu-aarch64") or shutil.which(
            "qemu-aarch64-static")
        if not shutil.which(cross) or not qemu:
            skipped.append(f"AArch64: wants {cross} and qemu-aarch64 (Debian: "
                           "g++-aarch64-linux-gnu, qemu-user)")
        elif is_x86:
            for options in ("-O3", "-O0"):
                program = build(root, folder / f"aarch64{options}", [cross], [options], {})
                note(f"AArch64 under qemu {options}", [qemu, program], "neon")
    for name, line in hashes.items():
        print(f"{line}  {name}")
    for line in skipped:
        print(f"skipped: {line}")
    if len(set(hashes.values())) > 1:
        print(f"the builds differ (AXG_SEED={SEED}, AXG_COUNT={COUNT})")
        sys.exit(1)
    line = next(iter(hashes.values()), "")
    far, overflows = map(int, re.findall(r"(\d+) (?:far|overflows)", line) or (0, 0))
    if not 0.1 * int(COUNT) < far < 0.9 * int(COUNT) or overflows == 0:
        print(f"the questions show nothing: {line}")
        sys.exit(1)
    sys.exit(SKIPPED if len(hashes) < 2 or any("AArch64" in s for s in skipped) else 0)


if __name__ == "__main__":
    main()
