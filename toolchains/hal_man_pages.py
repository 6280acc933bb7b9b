#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The pages of man, section 9, of the two HAL components: types and directions of the pins from
their sources, meanings from the tables of docs/reference/linuxcnc.md. A pin without a meaning, or a
meaning without a pin, ends it.

Example: toolchains/hal_man_pages.py 0.1.0 . build/host-package/packaged"""
import pathlib
import re
import sys

from man_pages import plain, rows_of

PAGE = "docs/reference/linuxcnc.md"
LOADING = {
    "axguard_stop": ("stops the joints of LinuxCNC when the guard's permit ends",
                     ".B loadrt axguard_stop joints=\\fIN\\fR\n.br\n"
                     ".B addf axguard\\-stop servo\\-thread",
                     ".SH FUNCTIONS\n.TP\n.B axguard\\-stop\n(uses floating point) directly after "
                     "motion\\-controller: commands in, permits, commands out\n"),
    "axguard-hal": ("collision guard beside a machine that LinuxCNC controls",
                    ".B loadusr \\-W axguard\\-hal \\fIMACHINE.yaml\\fR \\-\\-linear\\-units "
                    "\\fI[TRAJ]LINEAR_UNITS\\fR \\fR[options]",
                    "")}
SOURCES = {"axguard_stop": ("firmware_if/linuxcnc/axguard_pins.h", ""),
           "axguard-hal": ("firmware_if/linuxcnc/axguard_hal.c", "axguard.")}
PIN = re.compile(r'\b(?:NEW_PIN\((?P<type>\w+), (?:(?P<way>HAL_\w+), )?&[^,]+, "(?P<name>[^"]+)"'
                 r'|hal_pin_(?P<type2>\w+)_newf\((?P<way2>HAL_\w+),[^"]+"(?P<name2>[^"]+)")')


def pins_of(source, prefix):
    """Type and direction of each pin by its name."""
    pins = {}
    for match in PIN.finditer(source):
        if match["name"]:
            name, way = prefix + match["name"], match["way"] or "HAL_OUT"
            pins[name.replace("%d", "N")] = (match["type"], way)
        else:
            pins[match["name2"].replace("%d", "N")] = (match["type2"], match["way2"])
    return {name: (kind, way.removeprefix("HAL_").lower()) for name, (kind, way) in pins.items()}


def meanings_of(page, component):
    """What the page's table states of each pin; `.name` after a pin has its beginning."""
    section = page.split(f"\n## Pins of {component}\n")[1].split("\n## ")[0].split("\n### ")[0]
    meanings = {}
    for row in rows_of(section):
        names = re.findall(r"`([^`]+)`", row[0])
        for name in names:
            whole = names[0].rsplit(".", 1)[0] + name if name.startswith(".") else name
            meanings[whole] = row[-1]
    # A pin with a promise of its own is described by it.
    promises = {row[0].strip("`"): row[1] for row in rows_of(
        page.split("\n## Channels\n")[1].split("\n## ")[0])}
    return {name: promises.get(name, meaning) for name, meaning in meanings.items()}


def faults_of(component, pins, meanings):
    found = [f"{PAGE}: \"Pins of {component}\" has no {name}" for name in pins.keys() - meanings]
    return found + [f"{PAGE}: {component} has no pin {name}" for name in meanings.keys() - pins]


def manual(component, version, pins, meanings):
    purpose, synopsis, functions = LOADING[component]
    name = plain(component)
    text = (f'.TH {plain(component.upper())} 9 "" "axguard {version}" "HAL Component"\n'
            f".SH NAME\n{name} \\- {purpose}\n.SH SYNOPSIS\n{synopsis}\n{functions}.SH PINS\n")
    for pin, (kind, way) in pins.items():
        text += f".TP\n.B {plain(pin)} \\fR{kind} {way}\n{plain(meanings[pin])}\n"
    other = next(each for each in LOADING if each != component)
    return text + (f".SH SEE ALSO\n.BR {plain(other)} (9),\n.BR axguard\\-hal (1)\n.PP\n"
                   "linuxcnc.md in /usr/share/doc/axguard\\-doc/pages/reference\n"
                   ".SH LICENSE\nGPL\\-2.0\\-or\\-later\n")


def main():
    version, root, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    page = (root / PAGE).read_text(encoding="utf-8")
    faults, manuals = [], {}
    for component, (source, prefix) in SOURCES.items():
        pins = pins_of((root / source).read_text(encoding="utf-8"), prefix)
        meanings = meanings_of(page, component)
        faults += faults_of(component, pins, meanings)
        manuals[component] = (pins, meanings)
    if faults:
        sys.exit("\n".join(sorted(faults)))
    out.mkdir(parents=True, exist_ok=True)
    for component, (pins, meanings) in manuals.items():
        (out / f"{component}.9").write_text(manual(component, version, pins, meanings),
                                            encoding="utf-8")


if __name__ == "__main__":
    main()
