#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The README's figures, in its text, its table and its drawings, are those of the records.

A figure may have fewer digits than its record: then the record, rounded to as many, is the same.
"""
import decimal
import pathlib
import re
import sys

from sources import finish, read_text

README, TIMES, BARS = "README.md", "docs/measurements/peers.txt", "docs/figures/peers.svg"
GUARD, FRESH = "docs/figures/guard.svg", "docs/measurements/fresh-debian.md"
# The page with the claim, what it claims; the page that holds it, what that has. Groups are equal.
CLAIMS = [
    (README, r"At ([\d,]+) poses near contact", "docs/measurements/query-exact.md",
     r"Count \| ([\d,]+) poses"),
    (README, r"find the (\d+) contacts", "docs/measurements/query-exact.md",
     r"contacts by exact predicates \| (\d+)"),
    (README, r"\[(\d+) missed in\s1e8\]", "docs/measurements/certified-pairs.md",
     r"missed contacts \| (\d+)"),
    (README, r"\[(\d+) us with\s+AVX-512 and (\d+)\s+us\s+with\s+AVX2\]",
     "docs/measurements/bounded-cycle.md", r"\| 3, default \|[^|]*\| (\d+), \d+ \| (\d+)"),
    (README, r"default deadline is (\d+) us", "docs/theory/architecture.md",
     r"last frame to verdict \| (\d+) us"),
    (GUARD, r"ends after (\d+) to (\d+) ms", "docs/reference/machine-file.md",
     r"`permit_samples` .*\[default: \[(\d+), (\d+)\]"),
    (GUARD, r"every (\d+) ms", "docs/theory/architecture.md",
     r"sample period T; [^|]*\| (\d)000 us"),
]
PEER = re.compile(r"^(axguard|FCL|Coal|Bullet|ODE) \S+" + r" +([\d.]+)" * 3 + r" +(\d+)" * 3, re.M)
ROW = re.compile(r"^\| (axguard|FCL|Coal|Bullet|ODE)\b[^|]*" + r"\| ([\d.]+) " * 3, re.M)


def same(claim, record):
    claim, record = (decimal.Decimal(value.replace(",", "")) for value in (claim, record))
    step = decimal.Decimal(1).scaleb(claim.as_tuple().exponent)
    return claim == record.quantize(step, decimal.ROUND_HALF_UP)


def claim_faults(texts, claims=tuple(CLAIMS)):
    for page, claimed, record, held in claims:
        found, wanted = re.search(claimed, texts[page]), re.search(held, texts[record])
        if not found or not wanted:
            yield f"{record if found else page}: no longer has {held if found else claimed!r}"
        elif not all(map(same, found.groups(), wanted.groups())):
            yield f"{page}: {found.group()!r}, but {record} has {wanted.group()!r}"


def peer_faults(readme, page, times, bars):
    """Table of the README, the record's page, its last raw table, and the drawn bars."""
    raw = {row[1]: row.groups()[1:]
           for row in PEER.finditer(times.rpartition("which the README has:")[2])}
    tables = {name: {row[1]: row.groups()[1:] for row in ROW.finditer(text)}
              for name, text in ((README, readme), ("docs/measurements/peers.md", page))}
    for name, table in tables.items():
        if not raw or table.keys() != raw.keys():
            yield f"{name}: has {sorted(table)}, but {TIMES} has {sorted(raw)}"
        for library in table.keys() & raw.keys():
            if not all(map(same, table[library], raw[library])):
                yield f"{name}: {library} {table[library]}, but {TIMES} has {raw[library]}"
    contacts = re.search(r"all five libraries find the (\d+) contacts", readme)
    for library, row in raw.items():
        if not contacts or row[3:] != (contacts[1], "0", "0"):
            yield f"{README}: {library} found {row[3]} contacts, {row[4]} missed, {row[5]} false"
        median, _, slowest = tables[README].get(library, ("", "", ""))
        if f">{library}</text>" not in bars or f">{median}, {slowest}</text>" not in bars:
            yield f"{BARS}: not \"{median}, {slowest}\" of {library}: run draw_peers.py"


def demo_faults(readme, fresh):
    """A time of the demo that the README states is that of the record, in s or whole minutes."""
    record = re.search(r"`\./demo\.sh` \| (\d+) s", fresh)
    stated = re.search(r"\[([^\]]*)\]\(docs/measurements/fresh-debian\.md\)", readme)
    if not record or not stated:
        yield f"{README}: no link to the time of the demo in {FRESH}"
        return
    value = re.search(r"(\d+) (s|min)", stated[1])
    if value and int(value[1]) != (int(record[1]) if value[2] == "s" else
                                   round(int(record[1]) / 60)):
        yield f"{README}: the demo takes {stated[1]}, but {FRESH} has {record[1]} s"


def deadline_faults(readme, architecture):
    """The longest cycle has the share of the deadline that the engine has."""
    share = re.search(r"share of it for the longest cycle \| ([\d.]+)", architecture)
    deadline = re.search(r"default deadline is (\d+) us", readme)
    most = re.search(r"takes at most (\d+) us", readme)
    if not (share and deadline and most) or \
            decimal.Decimal(share[1]) * int(deadline[1]) != int(most[1]):
        yield f"{README}: the longest cycle's share of the deadline is not as in the architecture"


def main():
    root = pathlib.Path(sys.argv[1])
    texts = {name: read_text(root, name) for claim in CLAIMS for name in (claim[0], claim[2])}
    faults = list(claim_faults(texts))
    faults += peer_faults(texts[README], read_text(root, "docs/measurements/peers.md"),
                          read_text(root, TIMES), read_text(root, BARS))
    faults += demo_faults(texts[README], read_text(root, FRESH))
    faults += deadline_faults(texts[README], texts["docs/theory/architecture.md"])
    finish(faults)


if __name__ == "__main__":
    main()
