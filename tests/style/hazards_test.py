#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The check of the hazards can fail: over small lists and files with one fault each, and over the
tree's own, from which one test, promise or claim after the other is taken away."""
import pathlib
import re
import sys

import hazards
import registered
from hazards import hazard_tables
from sources import finish, read_text, skip, tracked_files

FAULTS = []
GOOD = """
[[group]]
letter = "A"
title = "Axes"
[[hazard]]
id = "A1"
way = "an axis goes on"
prevents = "the timer"
remains = "the timer's own fault"
against = "Nothing watches the timer itself."
claims = ["../theory/stop.md#proof"]
promises = ["motion ends"]
tests = ["Timer.Ends", "vm_kill"]
[[hazard]]
id = "A2"
way = "a clamp is in the way"
prevents = "nothing"
remains = "all of it"
against = "It is the usual case."
claims = ["safety.md"]
promises = []
tests = []
no_test = "no sensor reports it"
"""
PAGE = """## Promises it relies on

| Promise | Given by |
|---|---|
| motion ends | board |

## Next

| Other | table |
|---|---|
| no promise | |
"""
THEORY = {"docs/theory/stop.md": "Claim: it stops.\n", "docs/theory/gpu.md": "Claim: none here.\n"}
TESTS = {"Timer.Ends", "Timer.Begins", "vm_kill"}


def expect(what, condition):
    if not condition:
        FAULTS.append(f"hazards_test: {what}")


def found(listed=GOOD, page=PAGE, theory=None, tests=frozenset(TESTS)):
    return hazards.faults_in(listed, page, THEORY if theory is None else theory, tests)


def lists_are_judged():
    expect(f"a sound list: {found()}", found() == [])
    for old, new, words in [
            ('"Timer.Ends", ', '"Timer.End", ', "no test Timer.End (nearest: Timer.Ends)"),
            ('"vm_kill"', '"Timer.Ends"', "named twice"),
            ('no_test = "no sensor reports it"\n', "", "no word why none can exist"),
            ('no_test = "no sensor reports it"', 'no_test = " "', "hazard A2"),
            ('no_test = "no sensor reports it"', 'gap = "nobody tried"', "no word why none can"),
            ('against = "It is the usual case."', 'against = "none"', "no argument"),
            ('against = "It is the usual case."\n', "", "hazard A2"),
            ('id = "A2"', 'id = "A3"', "expected A2"), ('id = "A2"', 'id = "B1"', "no group"),
            ('title = "Axes"', 'title = "Axes"\n[[group]]\nletter = "B"\ntitle = "Bus"',
             "group B has no hazard"),
            ('title = "Axes"', 'name = "Axes"', "a group has"),
            ('way = "an axis goes on"', 'way = "an axis goes on"\nwhy = "so"', "hazard A1"),
            ('tests = []', 'tests = "vm_kill"', "hazard A2"),
            ('claims = ["safety.md"]', "claims = []", "no page states"),
            ('claims = ["../theory/stop.md#proof"]', 'claims = ["safety.md"]',
             "docs/theory/stop.md: no hazard states its claim"),
            ('promises = ["motion ends"]', "promises = []", 'promise "motion ends"'),
            ("promises = []", 'promises = ["no promise"]', 'no promise "no promise"'),
            ('[[group]]', "[hazards]\n[[group]]", "unknown key hazards"),
            ('"A1"', '"A1', "docs/reference/hazards.toml:")]:
        expect(f"{old} occurs", GOOD.count(old) >= 1)
        faults = found(GOOD.replace(old, new, 1))
        expect(f"{new or 'without ' + old}: {faults}", any(words in fault for fault in faults))
    expect("a new promise", any("drives brake" in fault for fault in found(
        page=PAGE.replace("| motion ends", "| drives brake | maker |\n| motion ends"))))
    expect("no table of promises", any("found no table" in fault for fault in found(
        page=PAGE.replace("## Promises", "## The promises"))))
    expect("a new claim", any("docs/theory/new.md" in fault for fault in found(
        theory=THEORY | {"docs/theory/new.md": "# New\n\nClaim: more.\n"})))


CMAKE = {
    "tests/CMakeLists.txt": """
foreach(kind unit gpu)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${kind}/*_test.cpp)
  add_test(NAME ${kind}.${name} COMMAND ${kind}_tests ${name})
endforeach()
include(more.cmake OPTIONAL)
# add_test(NAME in_a_comment COMMAND x)
if(FALSE)
  add_test(NAME never COMMAND x)
elseif(AXG_CUDA)
  if(A)
    add_test(NAME nested COMMAND x)
  endif()
else()
  add_test(NAME otherwise COMMAND x)
endif()
""",
    "tests/more.cmake": """
set(folders vm model)
foreach(folder IN LISTS folders)
  add_subdirectory(${folder})
endforeach()
""",
    "tests/vm/CMakeLists.txt": """
function(a_vm_test name)
  add_test(NAME vm_${name} COMMAND boot ${ARGN})  # vm_comment
endfunction()
a_vm_test(kill faults.py "kill (hard)")
""",
    "tests/model/CMakeLists.txt": "foreach(what IN ITEMS table states)\n"
                                  "add_test(NAME model.${what} COMMAND x)\nendforeach()\n",
    "tests/forgotten/CMakeLists.txt": "add_test(NAME forgotten COMMAND x)\n",
    "tests/unit/a_test.cpp": "TEST(A, Holds) {}\n// TEST(A, Comment) {}\n/*\nTEST(A, Block) {}\n"
                             "*/\nTEST_P(A,\n       Wraps) {}\nTEST(A, DISABLED_Rests) {}\n",
    "tests/unit/a.cpp": "TEST(A, InNoProgram) {}\n",
    "tests/fuzz/b_test.cpp": "TEST(B, OfNoKind) {}\n",
}


def registrations_are_read():
    expect(f"ctest: {sorted(registered.ctest_names(CMAKE))}", registered.ctest_names(CMAKE) == {
        "nested", "otherwise", "vm_kill", "model.table", "model.states"})
    expect(f"GoogleTest: {sorted(registered.gtest_names(CMAKE))}",
           registered.gtest_names(CMAKE) == {"A.Holds", "A.Wraps"})


def without(text, line):
    """The text without one line, which occurs once."""
    expect(f"{line} occurs once", text.count(f"{line}\n") == 1)
    return text.replace(f"{line}\n", "")


def trees_own_registrations_matter(files):
    """Each way in which tests are registered: what is taken away is no test any more."""
    for name, line, test in [
            ("tests/can_vm/CMakeLists.txt", "axg_can_vm_test(held faults.py held)", "can_vm_held"),
            ("tests/model/CMakeLists.txt", "  foreach(what table relation properties)",
             "model.relation"),
            ("tests/style/CMakeLists.txt", 'axg_style_test(api_reference)', "style.api_reference"),
            ("tests/CMakeLists.txt", "include(extra.cmake OPTIONAL)", "oracle.board")]:
        expect(f"{test} is registered", test in registered.ctest_names(files))
        less = files | {name: without(files[name], line)}
        expect(f"{test} without {line}", test not in registered.ctest_names(less))
    name, test = "tests/unit/core/guard/guard_state_test.cpp", "GuardState.EveryInputInEveryPhase"
    renamed = files[name].replace("EveryInputInEveryPhase", "EveryInput")
    expect(f"{test} is registered", test in registered.gtest_names(files))
    expect(f"{test} renamed", test not in registered.gtest_names(files | {name: renamed}))


def bold_tests_are_named_by_a_mutant():
    mutants = hazard_tables.names_in_mutants('[[mutant]]\ntest = "unit_tests A.*:A.One:B.Two*"\n')
    expect(f"patterns name no test: {mutants}", mutants == {"A.One"})
    hazard = {"tests": ["A.One", "A.Two"], "no_test": "so", "gap": "that"}
    expect("tests, reason and gap", hazard_tables.shown_by(hazard, mutants) ==
           "**`A.One`**, `A.Two`; None can: so; **Gap**: that")
    expect("a link", hazard_tables.link("a/b.md#11-the-box") == "[the box](a/b.md#11-the-box)")


def trees_own_list_is_judged(root, files):
    """Of the tree's own list each test, promise and claim is needed."""
    listed, page = read_text(root, hazards.LIST), read_text(root, hazards.PAGE)
    pages = {name: read_text(root, name) for name in tracked_files(root)
             if hazards.THEORY.match(name)}
    tests = registered.ctest_names(files) | registered.gtest_names(files)
    expect("the tree's own list", hazards.faults_in(listed, page, pages, tests) == [])
    own = hazard_tables.read_hazards(listed)[1]
    named = {test for hazard in own for test in hazard["tests"]}
    for test in sorted(named):
        faults = [fault for hazard in own for fault in hazards.test_faults(hazard, named - {test})]
        expect(f"without {test}", any(f"no test {test}" in fault for fault in faults))
    promises = hazards.promises_of(page)
    for promise in promises:
        less = [hazard | {"promises": [each for each in hazard["promises"] if each != promise]}
                for hazard in own]
        faults = list(hazards.promise_faults(less, promises))
        expect(f"no hazard rests on {promise}: {faults}", len(faults) == 1)
    claims = [name for name, text in pages.items() if hazards.CLAIM.search(text)]
    for name in claims:
        less = [hazard | {"claims": [each for each in hazard["claims"]
                                     if pathlib.PurePosixPath(name).name not in each] or ["x.md"]}
                for hazard in own]
        faults = list(hazards.claim_faults(less, pages))
        expect(f"no hazard states the claim of {name}", faults == [
            f"{name}: no hazard states its claim"])
    print(f"{len(own)} hazards, {len(named)} tests, {len(promises)} promises, {len(claims)} claims")
    expect("enough to judge", len(own) >= 40 and len(promises) >= 9 and len(claims) >= 8)
    made = hazard_tables.page_of(root, page)
    old = hazard_tables.page_of(root, re.sub(r"^\| S1 \|.*\n", "", page, flags=re.M))
    expect("a row taken from the page is made again", made == page == old)


def main():
    if hazard_tables.tomllib is None:
        skip("tomllib comes with Python 3.11")
    root = pathlib.Path(sys.argv[1]).resolve()
    files = {name: read_text(root, name) for name in tracked_files(root)
             if registered.is_read(name)}
    lists_are_judged()
    registrations_are_read()
    trees_own_registrations_matter(files)
    bold_tests_are_named_by_a_mutant()
    trees_own_list_is_judged(root, files)
    finish(FAULTS)


if __name__ == "__main__":
    main()
