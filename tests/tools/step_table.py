#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints how long each step of a run took beside the last run on record, and their sum. Never fails
on a time: above WARN_MIN it says so, for a check that grows costs every change.

step_table.py STEPS.csv ROOT [--kind night]       STEPS.csv: a line a step, as steps.sh writes it
step_table.py STEPS.csv ROOT --keep --machine NAME   also makes it the record of its kind

A kind of run: day; full, which is by day with AXG_CHECKED_COMMIT=none, so that nothing is left out;
night.
"""
import argparse
import csv
import datetime
import pathlib
import subprocess
import sys

RECORD = "docs/measurements/check-steps.csv"
HEAD = ["run", "commit", "date", "machine", "step", "seconds"]
WARN_MIN = 40


def read_steps(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [(row[1], int(row[0])) for row in csv.reader(file)]


def read_record(path):
    if not path.is_file():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def table(steps, recorded):
    """Lines: step, seconds now, seconds on record; and the sums."""
    yield f"{'step':34} {'s':>6} {'record':>7}"
    for name, seconds in steps:
        yield f"{name:34} {seconds:>6} {recorded.get(name, '-'):>7}"
    total = sum(seconds for _, seconds in steps)
    yield f"{'all steps':34} {total:>6} {sum(recorded.values()) or '-':>7}"
    if total > WARN_MIN * 60:
        yield (f"warning: {total / 60:.0f} min, aim {WARN_MIN} at most: shorten the check before "
               "anything else is added to it (docs/measurements/whole-run.md)")


def keep(path, rows, kind, machine, steps, root):
    commit = subprocess.run(["git", "-C", str(root), "rev-parse", "--short=10", "HEAD"], text=True,
                            capture_output=True, check=True).stdout.strip()
    date = datetime.date.today().isoformat()
    rows = [row for row in rows if row["run"] != kind]
    rows += [dict(zip(HEAD, (kind, commit, date, machine, name, seconds)))
             for name, seconds in steps]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, HEAD, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: row["run"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("steps", type=pathlib.Path)
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--kind", default="day", choices=["day", "full", "night"])
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--machine", help="with --keep: its name in docs/measurements/index.md")
    options = parser.parse_args()
    if options.keep and not options.machine:
        parser.error("--keep needs --machine NAME")
    steps, rows = read_steps(options.steps), read_record(options.root / RECORD)
    recorded = {row["step"]: int(row["seconds"]) for row in rows if row["run"] == options.kind}
    print("\n".join(table(steps, recorded)))
    if options.keep:
        keep(options.root / RECORD, rows, options.kind, options.machine, steps, options.root)
    return 0


if __name__ == "__main__":
    sys.exit(main())
