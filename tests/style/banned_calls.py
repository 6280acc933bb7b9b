#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calls that core/ may not make: it neither allocates by hand nor throws, prints, waits or asks a
library whose sine differs from one processor to the next."""
import pathlib
import re
import sys

from sources import finish, is_cpp, read_text, tracked_files, without_comments_and_strings

BANNED = [
    (r"(?<![\w:])(?:::)?new\b(?!\s*\()", "new: take memory from the arena at init"),
    (r"\b(?:malloc|calloc|realloc|aligned_alloc|posix_memalign)\s*\(", "allocation by hand"),
    (r"(?<![\w.>])(?:std::)?free\s*\(", "free"),
    (r"(?<!=\s)\bdelete\b(?!\s*;)", "delete"),
    (r"\b(?:throw|try|catch)\b", "exceptions: return a status"),
    (r"\b(?:dynamic_cast|typeid)\b", "run-time type information is off"),
    (r"\bf?s?n?printf\s*\(", "printing: core/ has no log"),
    (r"\bv?s?n?printf\s*\(", "printing: core/ has no log"),
    (r"\b(?:puts|fputs|putchar|fwrite|fopen)\s*\(", "files and printing"),
    (r"\bstd::(?:cout|cerr|clog|chrono|thread|mutex|async|filesystem|random_device)\b",
     "system, clock, log or thread"),
    (r"\b(?:time|clock|gettimeofday|clock_gettime|nanosleep|usleep|sleep)\s*\(", "clock"),
    (r"(?<![\w.>])(?:std::|::)?(?:sin|cos|tan|asin|acos|atan|atan2|sincos|sinf|cosf|tanf|atan2f|"
     r"exp|log|pow|hypot|cbrt)\s*\(",
     "libm differs between processors: core/base/sincos.hpp, or written out"),
    (r"\b(?:getenv|system|exit|abort|raise)\s*\(", "process"),
    (r"\bassert\s*\(", "assert is off in release: AXG_ASSERT"),
    (r"#\s*pragma\s+STDC\s+FP_CONTRACT\s+ON", "contraction is off everywhere"),
]
# (file, call): why it may stay. At load only, and no verdict depends on its last bits.
EXCEPTIONS = {
    ("core/mesh/mesh_shells.cpp", "std::atan2("): "solid angles, summed and rounded to whole turns",
    ("core/base/arena.cpp", "aligned_alloc("): "the one host allocation",
    ("core/base/arena.cpp", "std::free("): "of the one host allocation",
    ("core/base/assert.cpp", "abort("): "the safe stop after a broken assumption",
}
PATTERNS = [(re.compile(pattern), why) for pattern, why in BANNED]


def faults_in(name, text):
    for number, line in enumerate(without_comments_and_strings(text).split("\n"), 1):
        for pattern, why in PATTERNS:
            match = pattern.search(line)
            if match and (name, match.group().strip()) not in EXCEPTIONS:
                yield f"{name}:{number}: {match.group().strip()}: {why}"
                break


def main():
    root = pathlib.Path(sys.argv[1])
    faults = []
    for name in tracked_files(root):
        if name.startswith("core/") and is_cpp(name):
            faults += faults_in(name, read_text(root, name))
    finish(faults)


if __name__ == "__main__":
    main()
