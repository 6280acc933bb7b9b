#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The pages of man of the HAL components have every pin of the sources, and docs/reference/
linuxcnc.md a meaning for each; a pin taken away from either is found. The messages for LinuxCNC's
operator in docs/guide/every-day.md are those of the programs."""
import pathlib
import re
import subprocess
import sys
import tempfile

from sources import finish, is_code, tracked_files

SOURCE, PAGE = "firmware_if/linuxcnc/axguard_pins.h", "docs/reference/linuxcnc.md"
HAL = "firmware_if/linuxcnc/axguard_hal.c"
OPERATOR_PAGE, OPERATOR_PART = "docs/guide/every-day.md", "### What LinuxCNC's operator reads"
OF_LINUXCNC = {"joint N following error"}
# Of a copy: the file, what is changed in it, and the pin that is then missing.
CHANGES = [("", "", "", ""), (SOURCE, "axguard-stop.arm\"", "axguard-stop.arms\"", ".arm"),
           (PAGE, "`axguard.level`", "`axguard.levels`", "axguard.level"),
           (HAL, "\"axguard.program-line\"", "\"axguard.line\"", "axguard.program-line")]


def made(root, folder, change):
    """What the program prints, and the pages that it writes."""
    name, right, wrong, _ = change
    for file in (SOURCE, PAGE, HAL):
        text = (root / file).read_text(encoding="utf-8")
        copy = folder / file
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(text.replace(right, wrong) if file == name else text, encoding="utf-8")
    done = subprocess.run([sys.executable, "-B", root / "toolchains/hal_man_pages.py", "0",
                           folder, folder / "out"], text=True, capture_output=True, check=False)
    pages = "".join(path.read_text(encoding="utf-8") for path in (folder / "out").glob("*.9"))
    return done.stderr, pages


def faults_of(root):
    for change in CHANGES:
        with tempfile.TemporaryDirectory() as name:
            stderr, pages = made(root, pathlib.Path(name), change)
        if not change[0]:
            yield from filter(None, [stderr])
            yield from (f"the pages of man lack {pin}" for pin in
                        (".B axguard\\-stop.N.enable\\-out \\fRbit out", ".B axguard.cap \\fRu32")
                        if pin not in pages)
        elif change[3] not in stderr or pages:
            yield f"{change[0]}: a pin without its counterpart is not found: {change[3]}"


def message_faults(root):
    """Each message of the table, part by part as programs compose it, is in a source."""
    text = "".join((root / name).read_text(encoding="utf-8") for name in tracked_files(root)
                   if name.startswith(("firmware_if/", "core/guard/")) and is_code(name))
    text = re.sub(r'"\s+"', "", text)  # adjacent literals are one
    page = (root / OPERATOR_PAGE).read_text(encoding="utf-8").split(OPERATOR_PART)[1]
    for line in page.split("\n## ")[0].split("\n"):
        for message in re.findall(r"`([^`]+)`", line.strip("|").split("|")[0]):
            missing = [part for part in message.split(": ") if part not in text]
            if missing and message not in OF_LINUXCNC:
                yield f"{OPERATOR_PAGE}: no program prints {missing[0]!r}"


if __name__ == "__main__":
    where = pathlib.Path(sys.argv[1])
    finish(list(faults_of(where)) + list(message_faults(where)))
