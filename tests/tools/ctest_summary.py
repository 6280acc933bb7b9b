#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts ctest's own result files (JUnit), names what failed, and prints each reason for a skip
once, with the number of tests that gave it.

The last line printed is "N passed, N failed, N skipped"; exit code 1 when anything failed, when
nothing ran, or when a skipped test carries a label that was required.
"""
import argparse
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree


def labels_of(listing):
    """Labels by test name, from `ctest --show-only=json-v1`: the result file has none."""
    if not listing.is_file():
        return {}
    labels = {}
    for test in json.loads(listing.read_text(encoding="utf-8"))["tests"]:
        for item in test.get("properties", []):
            if item["name"] == "LABELS":
                labels[test["name"]] = item["value"]
    return labels


def skip_reason(case):
    """The reason that the test printed: GoogleTest's line after a skip, or a line 'skipped: ...'"""
    text = case.findtext("system-out") or ""
    reasons = re.findall(r": Skipped\n(.+)", text) + re.findall(r"(?m)^skipped: (.+)$", text)
    return "; ".join(dict.fromkeys(reason.strip() for reason in reasons)) or "no reason printed"


def judge(case):
    """passed, failed or skipped. A test that could not be started at all has failed."""
    if case.get("status") == "run" and case.find("failure") is None:
        return "passed"
    skipped = case.find("skipped")
    if skipped is not None and "SKIP_RETURN_CODE" in skipped.get("message", ""):
        return "skipped"
    return "failed"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=pathlib.Path, help="a result file, or a folder of them")
    parser.add_argument("--require", default="", help="labels whose tests may not be skipped")
    parser.add_argument("--failed-steps", type=int, default=0, help="counted with the failures")
    options = parser.parse_args()
    required = {label for label in options.require.split(",") if label}

    counts = {"passed": 0, "failed": 0, "skipped": 0}
    one = options.results.is_file()
    skipped = {}
    for path in [options.results] if one else sorted(options.results.glob("*.xml")):
        labels = labels_of(path.with_suffix(".json"))
        for case in ElementTree.parse(path).getroot().iter("testcase"):
            verdict = judge(case)
            name = f"{path.stem}: {case.get('name')}"
            if verdict == "skipped":
                reason = skip_reason(case)
                needed = sorted(required.intersection(labels.get(case.get("name"), [])))
                if needed:
                    verdict = "failed"
                    print(f"failed   {name}: skipped ({reason}), but tests labelled "
                          f"{', '.join(needed)} must run here: install what is missing, or "
                          f"point AXG_SHARED_DATA at the data")
                else:
                    skipped.setdefault(reason, []).append(name)
            elif verdict == "failed":
                print(f"failed   {name}")
            counts[verdict] += 1
    for reason, names in sorted(skipped.items()):
        which = names[0] if len(names) == 1 else f"{len(names)} tests"
        print(f"skipped  {which}: {reason}")
    counts["failed"] += options.failed_steps
    if sum(counts.values()) == 0:
        print("no test ran")
        counts["failed"] = 1
    print("{passed} passed, {failed} failed, {skipped} skipped".format(**counts))
    return 1 if counts["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
