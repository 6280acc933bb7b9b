#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Predicts times on boards that nobody had, from times on partitions of a large GPU: the table of
docs/theory/timing.md, which a test holds to this. What is assumed stands there.
    tests/tools/timing_table.py [FOLDER WITH THE RECORDS]      docs/measurements unless stated
"""
import fnmatch
import json
import pathlib
import sys

MEASURED_MHZ = 1980  # what the H200 says of itself; every record has it
# Launch, queries over the bus, and the way back, of one launch (gpu-fill.txt, "Where it goes").
LAUNCH_US = 11.3
# Warps that issue one double instruction take 32 lanes / 2 a clock there, 32 / 64 on the GPU that
# was measured; of a conversion from or to double 32 / 2 and 32 / 16.
DOUBLE_CYCLES = 32 / 2 - 32 / 64
CONVERSION_CYCLES = 32 / 2 - 32 / 16
# What each kernel has an entry of: lists of gpu-double.json.
ENTRIES = {"recheck_pairs": "rechecks", "test_leaves": "leaf_pairs", "open_pairs": "node_pairs",
           "prepare_queries": "queries", "prepare_parts": "parts"}
LANE_A_THREAD = ("queries", "parts")  # of the others a warp has one
# Name, multiprocessors of the partition that stands for it, MHz.
BOARDS = [("Orin Nano 8 GB", 8, 625), ("Orin Nano 8 GB, Super", 8, 1020),
          ("Orin NX 16 GB", 8, 918), ("AGX Orin 64 GB", 16, 1300), ("Thor T5000", 16, 1575)]
LONGEST = "longest cycle, double included"
# What is queried, its record, the command without its partition, launches.
WORK = [
    ("one pose, eight pairs", "gpu-cycles.json", "bench scene --engine cuda --sms {} --cycles *",
     1),
    ("512 queries", "gpu-cycles.json",
     "bench scene --engine cuda --sms {} --questions 512 --cycles *", 1),
    ("248,832 triangles, 512 queries", "gpu-cycles.json",
     "bench balls --engine cuda --sms {} --questions 512 --cycles *", 1),
    ("longest batch, one level", "gpu-longest.json", "bench --fill --levels 1 --sms {} --cycles *",
     1),
    (LONGEST, "gpu-plan.json", "bench --worst-case --engine cuda --stages 3 --sms {} *", 3),
]


def median_us(record, command):
    """Of the run with this command; of a longest batch the slowest layout out of the caches."""
    runs = [run for run in record["runs"]
            if fnmatch.fnmatch(run["command"].replace("axguard-lab", "axguard"),
                               "axguard " + command)]
    if len(runs) != 1:
        raise ValueError(f"{len(runs)} runs of axguard {command}")
    run = runs[0]
    if "lines" in run:
        return max(line["cycle_us"]["p50"] for line in run["lines"]
                   if line["condition"] == "cold cache")
    return run["cycle_us"]["p50"]


def predicted_us(measured_us, launches, board_mhz):
    """Without launches, and with each scaled as if it were work."""
    share = MEASURED_MHZ / board_mhz
    return max(0, measured_us - launches * LAUNCH_US) * share, measured_us * share


def double_us(instructions, lists, multiprocessors, board_mhz):
    """What double arithmetic of full lists takes longer than it did."""
    cycles = 0
    for kernel, entries in ENTRIES.items():
        count = lists[entries] / (32 if entries in LANE_A_THREAD else 1)
        double, conversions = instructions[kernel]
        cycles += count * (double * DOUBLE_CYCLES + conversions * CONVERSION_CYCLES)
    return cycles / multiprocessors / board_mhz


def table(folder):
    records = {name: json.loads((folder / name).read_text())
               for name in {work[1] for work in WORK}}
    lines = ["| us | " + " | ".join(f"{name} ({sms} x {mhz} MHz)" for name, sms, mhz in BOARDS)
             + " |", "|---" * (len(BOARDS) + 1) + "|"]
    double = json.loads((folder / "gpu-double.json").read_text())
    more = {name: [double_us(double["instructions"], lists, sms, mhz) for _, sms, mhz in BOARDS]
            for name, lists in double["lists"].items()}
    for name, file, command, launches in WORK:
        cells = []
        for at, (_, sms, mhz) in enumerate(BOARDS):
            low, high = predicted_us(median_us(records[file], command.format(sms)), launches, mhz)
            added = more["default plan"][at] if name == LONGEST else 0
            cells.append(f"{low + added:.0f} to {high + added:.0f}")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    for name, cells in more.items():
        lines.append(f"| {name}, more for double | " + " | ".join(f"{us:.0f}" for us in cells)
                     + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    here = pathlib.Path(__file__).resolve().parents[2]
    print(table(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "docs/measurements"),
          end="")
