#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The hazards of docs/reference/hazards.toml as the tables of docs/reference/safety.md.
    tests/tools/hazard_tables.py PAGE            prints the page with its tables made anew
    tests/tools/hazard_tables.py PAGE --write    writes it
"""
import pathlib
import re
import sys

from made_parts import table, with_parts

try:
    import tomllib
except ImportError:  # before Python 3.11
    tomllib = None

LIST = "docs/reference/hazards.toml"
MUTANTS = "tests/mutants/list.toml"
TEXTS = ("id", "way", "prevents", "remains", "against")
LISTS = ("claims", "promises", "tests")
OPTIONAL = ("no_test", "gap")


def has_form(entry):
    """Every text and list that a hazard needs, and nothing else."""
    texts = [entry.get(key) for key in TEXTS] + [entry[key] for key in OPTIONAL if key in entry]
    lists = [entry.get(key) for key in LISTS]
    return (set(entry) <= {*TEXTS, *LISTS, *OPTIONAL} and
            all(isinstance(text, str) and text.strip() for text in texts) and
            all(isinstance(each, list) and all(isinstance(text, str) for text in each)
                for each in lists))


def read_hazards(text):
    """(groups, hazards, faults of form). Only hazards that have the form are handed out."""
    try:
        whole = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        return [], [], [f"{LIST}: {error}"]
    groups, hazards, faults = [], [], []
    for group in whole.pop("group", []):
        if set(group) == {"letter", "title"}:
            groups.append(group)
        else:
            faults.append(f"{LIST}: a group has {sorted(group)}, expected letter and title")
    for entry in whole.pop("hazard", []):
        if has_form(entry):
            hazards.append(entry)
        else:
            faults.append(f"{LIST}: hazard {entry.get('id', '?')}: found {sorted(entry)}, expected "
                          f"texts {', '.join(TEXTS)} and lists {', '.join(LISTS)}, none empty text")
    faults += [f"{LIST}: unknown key {key}" for key in whole]
    return groups, hazards, faults


def names_in_mutants(text):
    """Tests that a fault made by hand has to fail. Of a pattern one test fails, and the list does
    not state which: it names none."""
    names = {name for mutant in tomllib.loads(text)["mutant"]
             for name in mutant["test"].partition(" ")[2].split(":")}
    return {name for name in names if "*" not in name}


def link(claim):
    """A page or heading as a link with its own words."""
    page, _, heading = claim.partition("#")
    words = heading or pathlib.PurePosixPath(page).stem
    return f"[{re.sub(r'^[0-9]+-', '', words).replace('-', ' ')}]({claim})"


def shown_by(hazard, mutants):
    def name(test):
        return f"**`{test}`**" if test in mutants else f"`{test}`"
    parts = [", ".join(name(test) for test in hazard["tests"])]
    parts += ["None can: " + hazard["no_test"]] if "no_test" in hazard else []
    parts += ["**Gap**: " + hazard["gap"]] if "gap" in hazard else []
    return "; ".join(part for part in parts if part)


def parts_of(groups, hazards, mutants):
    """The made parts of the page by their name."""
    tables = []
    for group in groups:
        rows = [[each[key] for key in TEXTS] for each in hazards
                if each["id"].startswith(group["letter"])]
        tables.append(f"### {group['title']}\n\n" + table(
            ["", "Way to a contact", "What prevents it", "What remains", "Against our claim"],
            rows))
    shown = [[each["id"], ", ".join(map(link, each["claims"])), "; ".join(each["promises"]),
              shown_by(each, mutants)] for each in hazards]
    return {"hazards": "\n\n".join(tables),
            "tests of the hazards": table(["", "Stated in", "Rests on", "Shown by"], shown)}


def page_of(root, page_text):
    """The page with its tables made anew."""
    groups, hazards, _ = read_hazards((root / LIST).read_text(encoding="utf-8"))
    mutants = names_in_mutants((root / MUTANTS).read_text(encoding="utf-8"))
    return with_parts(page_text, parts_of(groups, hazards, mutants))


def main():
    page = pathlib.Path(sys.argv[1])
    root = pathlib.Path(__file__).resolve().parents[2]
    text = page_of(root, page.read_text(encoding="utf-8"))
    if "--write" in sys.argv[2:]:
        page.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
