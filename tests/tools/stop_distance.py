#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How early stoppable mode stops: straight approaches of the paper's machine to its plate at
10 m/min, each simulated and replayed in both modes. What Z covers from the last permit to the first
contact, less what it needs at constant speed: the horizon, then the guaranteed stop. Prints
quantiles; all lengths in mm.

usage: stop_distance.py AXGUARD FOLDER [COUNT] [SEED] [--ahead SAMPLES [--promise P]] [--csv FILE]
                        [--fine MM,US]

--ahead: the board announces its commands so long before, and stops along them;
--promise independent: each axis brakes by itself.
--fine: flexible frames, positions good to MM beside their count of 0.1 um, latched within US;
--csv: one line an approach, kind and length"""
import argparse
import json
import pathlib
import random
import subprocess
import sys

SPEED = 10000.0 / 60.0  # mm/s
STOPPING, JERK = 3500.0, 50000.0  # of X, Y and Z in the machine file


def braking(speed):
    """From constant speed: the deceleration builds up by the jerk, then stays."""
    ramp = min(STOPPING / JERK, (2 * speed / JERK) ** 0.5)
    after = speed - 0.5 * JERK * ramp * ramp
    return ramp * (speed - JERK * ramp * ramp / 6) + after * after / (2 * STOPPING)


def stop_of(axguard, machine, trace, document, mode):
    done = subprocess.run([axguard, "replay", *machine, trace, f"--json={document}", "--mode", mode,
                           "--deadline-us", "10000000"], check=False, stdout=subprocess.DEVNULL)
    report = json.loads(document.read_text(encoding="utf-8"))
    if done.returncode != 10:
        sys.exit(f"{trace}: {mode} ended with {done.returncode}, wanted a stop")
    horizon_ms = report["proofs"]["horizon_ms"] if mode == "stoppable" else 0
    return report["stops"][0], horizon_ms * 1e-3


def machine_of(folder, ahead, promise, fine):
    """The paper's machine, as arguments; where it is not as it stands, a copy in the folder."""
    source = pathlib.Path(__file__).parents[2] / "config/machines/paper-trunnion.yaml"
    if not ahead and not fine:
        return [source]
    text = source.read_text(encoding="utf-8")
    assert text.count("\nguard:\n") == 1
    can = "  format: fd\n"
    if ahead:
        text = text.replace("\nguard:\n", f"\nguard:\n  promise: {promise}\n")
        can += f"  ahead: {{samples: {ahead}}}\n"
    if fine:
        error_mm, jitter_us = fine.split(",")
        text = text.replace("\nguard:\n", f"\nguard:\n  latch_jitter_us: {jitter_us}\n")
        text = text.replace("stopping_mm_s2:", f"position_error_mm: {error_mm}, stopping_mm_s2:")
    copy = folder / "changed.yaml"
    copy.write_text(text + can, encoding="utf-8")  # `can` is the last section
    return [copy, "--mesh-root", source.parent]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("axguard")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("count", type=int, nargs="?", default=100)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--ahead", type=int, default=0)
    parser.add_argument("--promise", default="path_keeping")
    parser.add_argument("--fine")
    parser.add_argument("--csv", type=pathlib.Path)
    arguments = parser.parse_args()
    axguard, folder, count = arguments.axguard, arguments.folder, arguments.count
    draw = random.Random(arguments.seed)
    machine = machine_of(folder, arguments.ahead, arguments.promise, arguments.fine)
    excess = {"straight down": [], "slanting": []}
    for i in range(count):
        kind = "slanting" if i % 2 else "straight down"
        x, y, c = draw.uniform(-100, 100), draw.uniform(-100, 100), draw.uniform(0, 360)
        aside = draw.uniform(-60, 60) if i % 2 else 0
        program = folder / "down.ngc"
        program.write_text(f"G21 G90 G94\nT1 M6\nG0 X{x:.3f} Y{y:.3f} Z-100 C{c:.3f}\nG4 P0.1\n"
                           f"G1 X{x + aside:.3f} Z-300 F10000\nM2\n", encoding="ascii")
        trace, document = folder / "down.log", folder / "down.json"
        subprocess.run([axguard, "simulate", *machine, program, "-o", trace], check=True,
                       stdout=subprocess.DEVNULL)
        stop, horizon_s = stop_of(axguard, machine, trace, document, "stoppable")
        contact, _ = stop_of(axguard, machine, trace, document, "contact")
        along_z = SPEED * 200.0 / (200.0 ** 2 + aside ** 2) ** 0.5
        covered = stop["axes"]["Z_mm"] + along_z * 1e-3 - contact["axes"]["Z_mm"]
        excess[kind].append(covered - along_z * horizon_s - braking(along_z))
    if arguments.csv:
        lines = [f"{kind},{value:.4f}\n" for kind, values in excess.items() for value in values]
        arguments.csv.write_text("kind,excess_mm\n" + "".join(lines), encoding="ascii")
    for kind, values in excess.items():
        values.sort()
        at = [values[int(share * (len(values) - 1))] for share in (0, 0.5, 0.9, 1)]
        print(f"{kind:14} {len(values):4} approaches: beyond {SPEED * horizon_s:.2f} mm of horizon "
              f"and {braking(SPEED):.2f} mm of braking: least {at[0]:.3f}, median {at[1]:.3f}, "
              f"90 % {at[2]:.3f}, most {at[3]:.3f} mm")


if __name__ == "__main__":
    main()
