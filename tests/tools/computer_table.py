#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The table of computers in docs/guide/every-day.md: a row of each file that
firmware_if/axguardd/service/host_report.py wrote, and of each GPU that timing_table.py predicts.
    tests/tools/computer_table.py docs/measurements docs/guide/every-day.md [--write]"""
import json
import pathlib
import re
import sys

import timing_table
from made_parts import table, with_parts

LIMIT_SHARE = 0.9  # of deadline_us, for the longest cycle (docs/guide/live.md, "Admission")
DEADLINES_US = (500, 1000)  # the usual one, and the whole period
HEAD = ["computer", "how known", "longest cycle, us", "worst wake-up, us", "at 1 kHz"]


def measured_row(document):
    admit, computer = document["admit"], document["computer"]
    cycles = admit["figures"]["cycles"]
    worst_us = max(document["latency"]["late_ns"]["max"],
                   admit["figures"]["wake_ups"]["latest_ns"]) / 1000
    # The interface says nothing of the computer: a record without a bus is of use, too.
    failed = [check["check"] for check in admit["checks"]
              if not check["passed"] and not check["found"].endswith("no such interface")]
    name = computer["processor"] if computer["board"] == "unknown" else \
        f"{computer['processor']} ({computer['board']})"
    realtime = "" if document["preempt_rt"] else ", no PREEMPT_RT"
    return [name, f"measured{realtime}, {cycles['engine']}", f"{cycles['fill_us']:.0f}",
            f"{worst_us:.0f}", "fit" if not failed else "not fit: " + ", ".join(failed)]


def predicted_rows(folder):
    rows = timing_table.table(folder).splitlines()
    names = [re.sub(r" \(.*", "", cell.strip()) for cell in rows[0].strip("|").split("|")[1:]]
    longest = next(row for row in rows if row.startswith(f"| {timing_table.LONGEST} |"))
    for name, cell in zip(names, longest.strip("|").split("|")[1:]):
        most_us = float(cell.split(" to ")[1])
        deadline_us = next((each for each in DEADLINES_US if most_us <= LIMIT_SHARE * each), None)
        yield [name, "predicted, GPU alone", cell.strip(), "unknown",
               "no" if deadline_us is None else
               f"perhaps, with `deadline_us: {deadline_us}`"]


def main():
    folder, page = (pathlib.Path(argument) for argument in sys.argv[1:3])
    records = [json.loads(path.read_text(encoding="utf-8"))
               for path in sorted((folder / "computers").glob("*.json"))]
    rows = [measured_row(record) for record in records] + list(predicted_rows(folder))
    text = with_parts(page.read_text(encoding="utf-8"), {"computers": table(HEAD, rows)})
    if "--write" in sys.argv[3:]:
        page.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
