#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Who may include whom. Data flows one way: a layer that looked back would no longer be testable
with arrays and a counter for time."""
import pathlib
import re
import sys

from sources import finish, includes, is_cpp, read_text, tracked_files

FOLDERS = {"core", "config", "firmware_if", "cuda", "hil_replay", "tests"}
MAY_INCLUDE = {
    "core": {"core"},
    "config": {"config", "core"},
    "firmware_if": {"firmware_if", "core"},
    # What both programs share as programs: its messages quote as those of the machine file do.
    "firmware_if/cli": {"firmware_if", "config", "core"},
    "cuda": {"cuda", "core"},
    # The deployed program and its C interface, above all libraries: they read a machine as the
    # workbench does.
    "firmware_if/axguardd": FOLDERS - {"tests"},
    "firmware_if/c_interface": FOLDERS - {"tests"},
    "hil_replay": FOLDERS - {"tests"},
    "tests": FOLDERS,
}
# The processor's own headers carry the SIMD lanes; they are no operating system.
PROCESSOR = {"immintrin.h", "xmmintrin.h", "pmmintrin.h", "arm_neon.h", "cpuid.h"}
# Parts of the standard library that are an operating system, a clock, a log or a thread.
NOT_IN_CORE = {
    "iostream", "ostream", "istream", "fstream", "sstream", "iomanip", "syncstream", "cstdio",
    "stdio.h", "filesystem", "chrono", "ctime", "time.h", "thread", "mutex", "shared_mutex",
    "condition_variable", "future", "stop_token", "semaphore", "barrier", "latch", "random",
    "locale", "clocale", "csignal", "signal.h", "coroutine", "exception", "stdexcept", "regex",
}
# Operating system headers of the loaders, which open files without following links out of a folder.
OPENING_FILES = {"fcntl.h", "unistd.h", "sys/stat.h", "sys/types.h", "sys/syscall.h",
                 "linux/openat2.h"}
SYSTEM = re.compile(r"(linux|sys|net|netinet|arpa|asm|bits)/|"
                    r"(fcntl|unistd|pthread|sched|poll|dlfcn|signal|dirent|termios|ifaddrs)\.h$")
ROOMS = {  # library -> the only folder that may know it (tests beside)
    "yaml-cpp/": {"config"},
    "cuda": {"cuda"},
    "gtest/": set(),
    "rapidcheck": set(),
    "CGAL/": set(),
    "nlohmann/": {"hil_replay", "firmware_if"},
}
ONE_FILE = {  # library that takes seconds to compile -> the only file that may include it
    "CLI/": "firmware_if/cli/command_line.cpp",
}


def fault_of(folder, path, quoted, may_include=None):
    """What is wrong with folder including path, or None."""
    may_include = may_include or MAY_INCLUDE[folder]
    other = path.split("/")[0]
    if other in FOLDERS and quoted:
        if other not in may_include:
            return f"{folder}/ may include {', '.join(sorted(may_include))} only"
        return None
    if quoted and folder != "tests":
        return "own headers are included from the repository root, libraries with < >"
    if folder == "tests":
        return None
    for library, rooms in ROOMS.items():
        if path.startswith(library) and folder not in rooms:
            return f"{path} belongs in {', '.join(sorted(rooms)) or 'tests'}/ alone"
    if folder == "core":
        if path in PROCESSOR or path.startswith("Eigen/"):
            return None
        if path in NOT_IN_CORE or "/" in path or path.endswith(".h"):
            return "core/ is pure: Eigen and std without system, clock, log, thread"
        return None
    if SYSTEM.match(path) and folder != "firmware_if":
        if folder == "hil_replay" or (folder == "config" and path in OPENING_FILES):
            return None
        return "firmware_if/ alone knows Linux"
    return None


def fault_of_file(name, path):
    for library, only in ONE_FILE.items():
        if path.startswith(library) and name != only:
            return f"{only} alone includes {library}, which takes seconds to compile"
    return None


def faults_in(folder, name, text):
    for number, path, quoted in includes(text):
        fault = (fault_of_file(name, path)
                 or fault_of(folder, path, quoted, MAY_INCLUDE.get(name.rpartition("/")[0])))
        if fault:
            yield f"{name}:{number}: includes {path}: {fault}"


def main():
    root = pathlib.Path(sys.argv[1])
    faults = []
    for name in tracked_files(root):
        folder = name.split("/")[0]
        if is_cpp(name) and folder in FOLDERS:
            faults += faults_in(folder, name, read_text(root, name))
    finish(faults)


if __name__ == "__main__":
    main()
