#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What is wrong on purpose lives in tests and the laboratory: no program or library that is
deployed contains code of hil_replay/lab or a word of an ablation. The check first finds that code
in a test program, which contains it: a check that sees nothing would pass everything. And nothing
but the guard of a trace or a simulation supposes that a person has armed."""
import pathlib
import re
import subprocess
import sys

from sources import finish, read_text, skip, tracked_files

# The functions of hil_replay/lab/ablations, and names that an ablation may have elsewhere.
DECLARED = re.compile(r"^void (\w+)\(", re.M)
HEADER = "hil_replay/lab/ablations/ablations.hpp"
WORD = re.compile(r"ablat(e|ion)|sabotag|wrong on purpose|forget[s_]*(jerk|path|dead)|"
                  r"has_dead_man", re.I)
DEPLOYED = re.compile(r"(core|config|cuda|firmware_if|hil_replay)/(?!lab/)")
SUPPOSES = re.compile(
    r"\b(?:supposes_arming|ignores_period)\b\s*(=(?!=)(?!\s*false\b)|\{(?!\s*(false)?\s*\}))")
SUPPOSING = "hil_replay/guard/timed_guard.cpp"
SOURCE = re.compile(r"\.(cpp|hpp|h|inl|cu|cuh)$")


def symbols_of(path):
    return subprocess.run(["nm", "-C", "--defined-only", str(path)], text=True,
                          capture_output=True, check=True).stdout


def strings_of(path):
    return subprocess.run(["strings", "-n", "6", str(path)], text=True, capture_output=True,
                          check=True).stdout


def laboratory_in(symbols):
    """Names of the laboratory in the output of `nm -C`."""
    return sorted(set(re.findall(r"\baxg::lab::[\w:]+", symbols)))


def words_in(text):
    return sorted({match.group() for match in WORD.finditer(text)})


def supposes_in(name, text):
    """Whether this file sets LiveOptions::supposes_arming, and is not the one that may."""
    return name != SUPPOSING and SUPPOSES.search(text) is not None


def main():
    root, witness = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    programs = [pathlib.Path(name) for name in sys.argv[3:]]
    missing = [path.name for path in [witness, *programs] if not path.exists()]
    if missing:
        skip(f"not built: {', '.join(missing)}")
    faults = []
    found = laboratory_in(symbols_of(witness))
    for name in DECLARED.findall(read_text(root, HEADER)):
        if f"axg::lab::{name}" not in found:
            faults.append(f"{witness.name}: nm shows no axg::lab::{name}; this check would not see "
                          "it elsewhere")
    for path in programs:
        symbols = symbols_of(path)
        if " axg::" not in symbols and " axg_" not in symbols:
            faults.append(f"{path.name}: nm shows no symbol of axguard; test it unstripped")
        faults += [f"{path.name}: contains {name} of the laboratory"
                   for name in laboratory_in(symbols)]
        faults += [f"{path.name}: contains the word '{word}'"
                   for word in words_in(symbols + strings_of(path))]
    for name in tracked_files(root):
        if DEPLOYED.match(name) and SOURCE.search(name):
            faults += [f"{name}: says '{word}': ablations are for tests and hil_replay/lab"
                       for word in words_in(read_text(root, name))]
            if supposes_in(name, read_text(root, name)):
                faults.append(f"{name}: sets supposes_arming: a deployed guard is armed by a "
                              f"person, while the axes stand; only {SUPPOSING} may")
    if SUPPOSES.search(read_text(root, SUPPOSING)) is None:
        faults.append(f"{SUPPOSING} does not set supposes_arming: this check sees nothing")
    finish(faults)


if __name__ == "__main__":
    main()
