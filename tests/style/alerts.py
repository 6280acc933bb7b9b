#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Alert rules and dashboard name only metrics, phases and labels that axguardd writes, and all
charts have units. With `promtool` (Debian: prometheus) the rules are checked and their cases run.

alerts.py ROOT names | promtool"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

from sources import finish, skip

FOLDER = pathlib.Path("firmware_if/axguardd/service")
RULES, CASES = "axguard-alerts.yaml", "axguard-alerts-test.yaml"
DASHBOARD = "axguard-dashboard.json"
METRIC = re.compile(r"\baxguard_[a-z_]+")


def written_by(root):
    """Names of metrics, and the labels of each, as metrics.cpp writes them."""
    source = (root / "firmware_if/live/metrics.cpp").read_text(encoding="utf-8")
    names = set(re.findall(r'\{"(\w+_total)"', source))
    names |= set(re.findall(r'\bhead\("(\w+)"', source))
    labels = set(re.findall(r'(\w+)=\\"\{', source))
    states = (root / "core/guard/guard_state.cpp").read_text(encoding="utf-8")
    return {f"axguard_{name}" for name in names}, labels, set(re.findall(r'return "(\w+)"', states))


def faults_of(root):
    names, labels, words = written_by(root)
    if len(names) < 20 or "bus" not in labels or "armed" not in words:
        yield "metrics.cpp is not read as it writes"
    for file in (RULES, CASES, DASHBOARD):
        text = (root / FOLDER / file).read_text(encoding="utf-8")
        yield from (f"{file}: axguardd writes no {name}"
                    for name in sorted(set(METRIC.findall(text)) - names))
        yield from (f"{file}: no phase {phase}" for phase in
                    re.findall(r'phase=\\?"(\w+)', text) if phase not in words)
        for name in re.findall(r"\$labels\.(\w+)|\{\{(\w+)\}\}", text):
            if (name[0] or name[1]) not in labels | {"file"}:
                yield f"{file}: no metric has the label {name}"
    for panel in json.loads((root / FOLDER / DASHBOARD).read_text(encoding="utf-8"))["panels"]:
        if not panel["fieldConfig"]["defaults"].get("unit"):
            yield f"{DASHBOARD}: {panel['title']}: no unit"
        if not all(METRIC.search(target["expr"]) for target in panel["targets"]):
            yield f"{DASHBOARD}: {panel['title']}: no metric"


def judged_by_promtool(root):
    if not shutil.which("promtool"):
        skip("promtool is not installed (apt install prometheus)")
    for words in (["check", "rules", RULES], ["test", "rules", CASES]):
        done = subprocess.run(["promtool", *words], cwd=root / FOLDER, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if done.returncode != 0:
            yield done.stdout


if __name__ == "__main__":
    judge = {"names": faults_of, "promtool": judged_by_promtool}[sys.argv[2]]
    finish(list(judge(pathlib.Path(sys.argv[1]).resolve())))
