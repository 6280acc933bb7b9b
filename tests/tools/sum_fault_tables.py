#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Adds up the tables that runs of property_tests guard_node_test with different seeds have printed:
counts are summed, of times (us) the worst is taken. sum_fault_tables.py OUTPUT..."""
import pathlib
import re
import sys

COUNTS = range(2, 7)  # injected, applied, detected, missed, late


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def joined(number, one, other):
    if one == "" or other == "":
        return one + other
    value = int(one) + int(other) if number in COUNTS else max(int(one), int(other))
    return str(value)


def main():
    heads, rows, totals = [], {}, [0] * 3
    for path in sys.argv[1:]:
        text = pathlib.Path(path).read_text()
        if "[  PASSED  ]" not in text:
            sys.exit(f"{path}: that run did not pass, or has not ended")
        lines = [line for line in text.splitlines() if line.startswith("|")]
        heads = lines[:2]
        for cells in map(cells_of, lines[2:]):
            key = tuple(cells[:2])
            known = rows.get(key, cells)
            rows[key] = [*key, *(joined(i, known[i], cells[i]) for i in range(2, len(cells)))
                         ] if key in rows else cells
        found = re.search(r"(\d+) faults, (\d+) cycles, (\d+) false stops", text)
        totals = [a + int(b) for a, b in zip(totals, found.groups())]
    print("\n".join(heads))
    for cells in rows.values():
        print("| " + " | ".join(cells) + " |")
    print("\n{} rows, {} faults, {} cycles, {} false stops".format(len(rows), *totals))


if __name__ == "__main__":
    main()
