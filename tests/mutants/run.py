#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes each fault of list.toml in a copy of the sources and expects its test to fail there.

Prints one line a mutant and a total; exit code 1 if a test passes with its fault, fails without it,
or if a mutant cannot be built. The copy and its build stay in FOLDER for the next run.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "style"))
import mutant_list  # noqa: E402
from sources import SKIPPED, tracked_files  # noqa: E402

SECONDS_MAX = 300  # of one test; a fault that never ends is found as well
NOTHING_RAN = 2  # tests/support/test_main.cpp


def copy_sources(root, names, tree):
    """Writes only what differs: the build in the copy is incremental."""
    for name in names:
        data, target = (root / name).read_bytes(), tree / name
        if not target.is_file() or target.read_bytes() != data:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data)
            target.chmod((root / name).stat().st_mode)
    for path in tree.rglob("*"):
        if path.is_file() and str(path.relative_to(tree)) not in names:
            path.unlink()


class Copy:
    def __init__(self, folder, options, jobs):
        self.tree, self.build = folder / "tree", folder / "build"
        self.options, self.jobs = options, jobs

    def configure(self):
        command = ["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja",
                   "-DCMAKE_BUILD_TYPE=Release", "-DAXG_CUDA=OFF", *self.options]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    def make(self, program):
        """Empty, or the end of what the compiler printed."""
        command = ["cmake", "--build", self.build, "-j", str(self.jobs), "--target", program]
        run = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return "" if run.returncode == 0 else run.stdout[-2000:]

    def passes(self, mutant):
        """None: the test did not run."""
        program = self.build / "tests" / mutant.program
        try:
            run = subprocess.run([program, f"--gtest_filter={mutant.filter}"], cwd=self.build,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                 timeout=SECONDS_MAX)
        except subprocess.TimeoutExpired:
            return False
        return None if run.returncode in (NOTHING_RAN, SKIPPED) else run.returncode == 0

    def judge(self, mutant):
        """killed, survived or not built."""
        path = self.tree / mutant.file
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(mutant.find, mutant.put), encoding="utf-8")
        try:
            printed = self.make(mutant.program)
            if printed:
                print(printed)
                return "not built"
            return "killed" if self.passes(mutant) is False else "survived"
        finally:
            path.write_text(text, encoding="utf-8")


def prepare(copy, mutants):
    """Builds the copy as it is. False: a test does not pass there."""
    copy.configure()
    for program in sorted({mutant.program for mutant in mutants}):
        printed = copy.make(program)
        if printed:
            print(printed)
            return False
    tests = {mutant.test: mutant for mutant in mutants}
    failed = [mutant for mutant in tests.values() if copy.passes(mutant) is not True]
    for mutant in failed:
        print(f"{mutant_list.LIST}:{mutant.line}: {mutant.test} does not pass without the fault")
    return not failed


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", type=pathlib.Path, help="the checkout; nothing is written to it")
    parser.add_argument("folder", type=pathlib.Path, help="for the copy and its build")
    parser.add_argument("--only", default="", help="mutants whose file or test contains this text")
    parser.add_argument("--shard", default="0/1", metavar="I/N",
                        help="every Nth mutant from the Ith on, so that several machines or copies "
                        "share the work [default: 0/1]")
    parser.add_argument("--jobs", type=int, default=int(os.environ.get("AXG_JOBS") or
                                                        len(os.sched_getaffinity(0))))
    parser.epilog = "What follows -- are options of cmake."
    end = arguments.index("--") if "--" in arguments else len(arguments)
    options = parser.parse_args(arguments[:end])
    options.cmake = arguments[end + 1:]
    return options


def main():
    options = options_of(sys.argv[1:])
    if mutant_list.tomllib is None:
        print("skipped: tomllib comes with Python 3.11")
        sys.exit(SKIPPED)
    root = options.root.resolve()
    names = tracked_files(root)
    mutants, faults = mutant_list.faults_in(root, names)
    mutants = [m for m in mutants if options.only in m.file or options.only in m.test]
    index, count = map(int, options.shard.split("/"))
    mutants = mutants[index::count]
    if faults or not mutants:
        print("\n".join(faults) or f"no mutant contains '{options.only}'")
        sys.exit(1)
    copy = Copy(options.folder.resolve(), options.cmake, options.jobs)
    start = time.monotonic()
    copy_sources(root, set(names), copy.tree)
    if not prepare(copy, mutants):
        sys.exit(1)
    print(f"built, and all tests pass without a fault, {time.monotonic() - start:.0f} s",
          flush=True)
    killed = 0
    for mutant in mutants:
        begin = time.monotonic()
        result = copy.judge(mutant)
        killed += result == "killed"
        print(f"{result:9} {mutant_list.LIST}:{mutant.line}: {mutant.file}: {mutant.why} "
              f"[{mutant.filter}] {time.monotonic() - begin:.0f} s", flush=True)
    print(f"{killed} of {len(mutants)} killed, {time.monotonic() - start:.0f} s")
    sys.exit(0 if killed == len(mutants) else 1)


if __name__ == "__main__":
    main()
