#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each mutant of tests/mutants/list.toml finds its text exactly once, and its test exists."""
import dataclasses
import fnmatch
import pathlib
import re
import sys

from sources import finish, read_text, skip, tracked_files

try:
    import tomllib
except ImportError:  # before Python 3.11
    tomllib = None

LIST = "tests/mutants/list.toml"
TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.M)


@dataclasses.dataclass
class Mutant:
    line: int  # in the list
    file: str
    find: str
    put: str
    test: str
    why: str

    @property
    def program(self):
        return self.test.partition(" ")[0]

    @property
    def filter(self):
        return self.test.partition(" ")[2]


def read_list(text):
    """The mutants, and faults of the list's own form."""
    try:
        entries = tomllib.loads(text).get("mutant", [])
    except tomllib.TOMLDecodeError as error:
        return [], [f"{LIST}: {error}"]
    lines = [n for n, line in enumerate(text.split("\n"), 1) if line.strip() == "[[mutant]]"]
    keys = {field.name for field in dataclasses.fields(Mutant)} - {"line"}
    mutants, faults = [], []
    for line, entry in zip(lines, entries):
        if set(entry) != keys or not all(isinstance(value, str) for value in entry.values()):
            faults.append(f"{LIST}:{line}: found {sorted(entry)}, expected texts {sorted(keys)}")
        else:
            mutants.append(Mutant(line, **entry))
    return mutants, faults


def names_of_tests(text):
    return {f"{suite}.{name}" for suite, name in TEST.findall(text)}


def faults_of(mutant, text, names):
    """@param text  of the mutant's file, None: no such file; @param names  of the kind's tests"""
    where = f"{LIST}:{mutant.line}"
    if text is None:
        yield f"{where}: no file {mutant.file}"
        return
    count = text.count(mutant.find)
    if count != 1:
        yield f"{where}: {mutant.file} contains the text {count} times, expected once"
    if mutant.put == mutant.find:
        yield f"{where}: the mutant changes nothing"
    for pattern in mutant.filter.split(":"):
        if not fnmatch.filter(names, pattern):
            yield f"{where}: {mutant.program} has no test {pattern!r}"


def faults_in(root, names):
    mutants, faults = read_list(read_text(root, LIST))
    tests = {}
    for name in names:
        kind = re.match(r"tests/(\w+)/.*_test\.cpp$", name)
        if kind:
            tests.setdefault(f"{kind[1]}_tests", set()).update(
                names_of_tests(read_text(root, name)))
    for mutant in mutants:
        text = read_text(root, mutant.file) if mutant.file in names else None
        faults += faults_of(mutant, text, tests.get(mutant.program, set()))
    return mutants, faults


def main():
    if tomllib is None:
        skip("tomllib comes with Python 3.11")
    root = pathlib.Path(sys.argv[1])
    finish(faults_in(root, tracked_files(root))[1])


if __name__ == "__main__":
    main()
