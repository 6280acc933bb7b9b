# SPDX-License-Identifier: Apache-2.0
"""What the README's prose states about its example is what axguard prints there.

readme_commands.py calls it in the folder where the five steps have run.
"""
import json
import re
import subprocess

MACHINE, OWN_FILE, TRACE = "my-machine.yaml", "config/machines/paper-trunnion.yaml", "down.log"
COUNTS = "no one two three four five six seven eight nine ten eleven twelve".split()
REVIEW = re.compile(r"In the example (\w+) lines stay, the limits of (\w+) axes and `(\w+)`")
UNCHECKED = re.compile(r"states why (\w+) pairs need no check")
DISTANCES = re.compile(
    r"the guard stops (?P<height>\d+) mm above it\. The longest stop from there takes "
    r"(?P<stop>\d+) mm: (?P<braking>\d+) mm of braking .* The quick proof needs (?P<proof>\d+) mm, "
    r".*\(`(?P<key>free_jerk: limited)` below `guard:`\), (?P<with_jerk>\d+) mm suffice")


def review_faults(claim, warnings):
    """Exactly the lines of that many axes, and one of the named key."""
    axes = [line for line in warnings if re.search(r"init: \w+: \{slot: \d", line)]
    keys = [line for line in warnings if re.search(rf"init: {claim[3]}:", line)]
    counts = [COUNTS[min(len(lines), 12)] for lines in (warnings, axes)]
    if counts != [claim[1], claim[2]] or len(keys) != 1 or len(axes) + 1 != len(warnings):
        yield f"{claim.group()!r}, but to review are {warnings}"


def machine_faults(ours, own):
    """Bodies by their hash; tools by number and length, as the meshes differ in turns."""
    if ours["hashes"]["kinematics"] != own["hashes"]["kinematics"]:
        yield f"the bodies of {MACHINE} do not equal those of {OWN_FILE}"
    tools = [[(tool["number"], tool["length_mm"]) for tool in machine["tools"]]
             for machine in (ours, own)]
    if tools[0] != tools[1]:
        yield f"the tools of {MACHINE} are {tools[0]}, those of {OWN_FILE} {tools[1]}"


def distance_faults(claim, machine, stop, with_jerk):
    """Stops as JSON: at the README's stop, and where the board limits jerk."""
    braking = next(axis for axis in machine["axes"] if axis["name"] == "Z")["stopping_distance"]
    reach = stop["axes"]["Z_mm"] - stop["why"]["reach"]["Z_mm"][0]
    for name, value in [("height", stop["pairs"][0]["clearance_mm"]), ("stop", reach),
                        ("braking", braking), ("proof", stop["why"]["needed_mm"]),
                        ("with_jerk", with_jerk["pairs"][0]["clearance_mm"])]:
        if int(claim[name]) != round(value):
            yield f"the distance \"{name}\" is {claim[name]} mm, but axguard has {value} mm"


def printed(folder, environment, *arguments):
    done = subprocess.run(["axguard", *arguments, "--json"], cwd=folder, env=environment,
                          text=True, capture_output=True, check=False)
    return json.loads(done.stdout)


def faults_of(readme, folder, environment):
    prose = " ".join(readme.split())
    claims = [pattern.search(prose) for pattern in (REVIEW, UNCHECKED, DISTANCES)]
    if not all(claims):
        return ["README.md: the example's claims are not as tests/style/readme_example.py has them"]
    ours = printed(folder, environment, "check", MACHINE)
    faults = list(review_faults(claims[0], ours["warnings"]))
    faults += machine_faults(ours, printed(folder, environment, "check", OWN_FILE))
    if COUNTS[len(ours["exclusions"])] != claims[1][1]:
        faults.append(f"{claims[1].group()!r}, but {len(ours['exclusions'])} do")
    text = (folder / MACHINE).read_text(encoding="utf-8")
    (folder / "jerk.yaml").write_text(
        text.replace("\nguard:\n", f"\nguard:\n  {claims[2]['key']}\n"), encoding="utf-8")
    stops = [printed(folder, environment, "replay", machine, TRACE)["stops"][0]
             for machine in (MACHINE, "jerk.yaml")]
    faults += distance_faults(claims[2], ours, *stops)
    return [f"README.md: {fault}" for fault in faults]
