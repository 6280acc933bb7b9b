#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Registers, shared memory, stack and spills of every kernel, from the compiler's own report,
against kernel_budget.txt. Needs nvcc and no GPU. Usage: kernel_budget.py ROOT NVCC ARCH..."""
import concurrent.futures
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
# As cuda/CMakeLists.txt has them.
FLAGS = ["-std=c++20", "--fmad=false", "-ftz=false", "-prec-sqrt=true", "-prec-div=true",
         "--expt-relaxed-constexpr", "-diag-suppress=128", "-O3", "-Xptxas=-v"]
FUNCTION = re.compile(r"Compiling entry function '\w*?(\w+?)_kernel")
STACK = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
USED = re.compile(r"Used (\d+) registers")
SHARED = re.compile(r"(\d+) bytes smem")


def read_budget(text):
    """{kernel: (registers, shared bytes)}"""
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    return {name: (int(registers), int(shared)) for name, registers, shared in rows}


def faults_in(name, arch, report, budget):
    stack, used, shared = STACK.search(report), USED.search(report), SHARED.search(report)
    if not FUNCTION.search(report) or not stack or not used:
        yield f"{name} {arch}: the compiler reported no kernel:\n{report}"
        return
    registers, shared = int(used.group(1)), int(shared.group(1)) if shared else 0
    print(f"{name} {arch}: {registers} registers, {shared} bytes shared")
    if any(int(count) for count in stack.groups()):
        yield f"{name} {arch}: {stack.group(0)}, wanted 0 of each"
    if name not in budget:
        yield f"{name}: no line in kernel_budget.txt"
        return
    for what, is_used, allowed in (("registers", registers, budget[name][0]),
                                   ("bytes of shared memory", shared, budget[name][1])):
        if is_used > allowed:
            yield f"{name} {arch}: {is_used} {what}, wanted at most {allowed}"


def main():
    root, nvcc, archs = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]
    if not shutil.which(nvcc):
        print(f"skipped: no {nvcc}; the CUDA toolkit provides it")
        sys.exit(SKIPPED)
    budget = read_budget((root / "tests/device/kernel_budget.txt").read_text())
    kernels = sorted((root / "cuda/engine").glob("*.cu"))
    faults = [f"{name}: in kernel_budget.txt, not in cuda/engine/"
              for name in budget if root / f"cuda/engine/{name}.cu" not in kernels]
    with tempfile.TemporaryDirectory() as folder:
        def report(job):
            kernel, arch = job
            out = pathlib.Path(folder) / f"{kernel.stem}_{arch}.cubin"
            run = subprocess.run([nvcc, *FLAGS, f"-arch=sm_{arch}", "-I", root, "-cubin", kernel,
                                  "-o", out], text=True, capture_output=True)
            return run.stdout + run.stderr
        jobs = [(kernel, arch) for kernel in kernels for arch in archs]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for (kernel, arch), text in zip(jobs, pool.map(report, jobs)):
                faults += faults_in(kernel.stem, f"sm_{arch}", text, budget)
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
