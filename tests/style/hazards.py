#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each hazard of docs/reference/hazards.toml is shown by tests that the tree registers, or states
why not; each promise of docs/reference/safety.md and each claim of docs/theory is in a hazard; the
tables of the page are those of the list."""
import difflib
import pathlib
import re
import sys

from registered import ctest_names, gtest_names, is_read
from sources import finish, read_text, skip, tracked_files

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
import hazard_tables  # noqa: E402

LIST = hazard_tables.LIST
PAGE = "docs/reference/safety.md"
PROMISES = "Promises it relies on"
AGAINST_WORDS_MIN = 4
THEORY = re.compile(r"docs/theory/.*\.md$")
CLAIM = re.compile(r"^Claim: (?!none\b)", re.M)


def promises_of(page):
    """First cells of the table of promises."""
    section = re.search(rf"^## {PROMISES}\n(.*?)(?=^## |\Z)", page, re.S | re.M)
    rows = re.findall(r"^\| *(.*?) *\|", section[1], re.M) if section else []
    return [row for row in rows[1:] if not re.fullmatch(r"-+", row)]


def id_faults(groups, hazards):
    letters = [group["letter"] for group in groups]
    wanted, counts = [], dict.fromkeys(letters, 0)
    for hazard in hazards:
        letter = hazard["id"][:1]
        if letter not in counts:
            yield f"{LIST}: {hazard['id']}: no group has its letter"
            continue
        counts[letter] += 1
        wanted.append((letters.index(letter), f"{letter}{counts[letter]}"))
    for hazard, (_, name) in zip(hazards, wanted):
        if hazard["id"] != name:
            yield f"{LIST}: {hazard['id']}: expected {name} in this place"
    if [place for place, _ in wanted] != sorted(place for place, _ in wanted):
        yield f"{LIST}: the hazards are not in the order of their groups"
    yield from (f"{LIST}: group {letter} has no hazard" for letter in letters if not counts[letter])


def test_faults(hazard, registered):
    where, tests = f"{LIST}: {hazard['id']}", hazard["tests"]
    if not tests and "no_test" not in hazard:
        yield f"{where}: no test, and no word why none can exist (no_test)"
    for test in tests:
        if test not in registered:
            near = difflib.get_close_matches(test, registered, 1)
            hint = f" (nearest: {near[0]})" if near else ""
            yield f"{where}: the tree registers no test {test}{hint}"
    if len(set(tests)) != len(tests):
        yield f"{where}: a test is named twice"
    if len(hazard["against"].split()) < AGAINST_WORDS_MIN:
        yield f"{where}: \"{hazard['against']}\" is no argument against the claim"


def promise_faults(hazards, promises):
    used = {promise for hazard in hazards for promise in hazard["promises"]}
    yield from (f"{PAGE}: no hazard rests on the promise \"{promise}\""
                for promise in promises if promise not in used)
    for hazard in hazards:
        yield from (f"{LIST}: {hazard['id']}: {PAGE} has no promise \"{promise}\""
                    for promise in hazard["promises"] if promise not in promises)
    if not promises:
        yield f"{PAGE}: found no table of promises below \"{PROMISES}\""


def claim_faults(hazards, pages):
    """pages: the text of each page of docs/theory by its name."""
    stated = {claim.partition("#")[0] for hazard in hazards for claim in hazard["claims"]}
    for name, text in sorted(pages.items()):
        if CLAIM.search(text) and f"../theory/{pathlib.PurePosixPath(name).name}" not in stated:
            yield f"{name}: no hazard states its claim"
    yield from (f"{LIST}: {hazard['id']}: no page states what prevents it"
                for hazard in hazards if not hazard["claims"])


def faults_in(listed, page, pages, registered):
    groups, hazards, faults = hazard_tables.read_hazards(listed)
    faults += id_faults(groups, hazards)
    for hazard in hazards:
        faults += test_faults(hazard, registered)
    faults += promise_faults(hazards, promises_of(page))
    faults += claim_faults(hazards, pages)
    return faults


def main():
    if hazard_tables.tomllib is None:
        skip("tomllib comes with Python 3.11")
    root = pathlib.Path(sys.argv[1]).resolve()
    names = tracked_files(root)
    files = {name: read_text(root, name) for name in names if is_read(name)}
    pages = {name: read_text(root, name) for name in names if THEORY.match(name)}
    page = read_text(root, PAGE)
    faults = faults_in(read_text(root, LIST), page, pages, ctest_names(files) | gtest_names(files))
    try:
        is_old = hazard_tables.page_of(root, page) != page
    except (ValueError, KeyError) as error:
        faults.append(f"{PAGE}: {error}")
    else:
        how = f"tests/tools/hazard_tables.py {PAGE} --write"
        faults += [f"{PAGE}: its tables are old; run: {how}"] if is_old else []
    finish(faults)


if __name__ == "__main__":
    main()
