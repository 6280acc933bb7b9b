#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""LinuxCNC as the controller, the guard beside it: harmless programs are not stopped, colliding
ones are stopped by the joints' own ramps before contact, and so is a machine whose guard is killed.
Usage: loop_test.py SOURCE BUILD [SCENARIO...] [--simulation-wait-us N] [--record FILE]"""
import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

from judge import contacts_of
from place import NotPossible, Place, module

SKIPPED = 77
PERIOD_S = 1e-3
# Of the machine files in firmware_if/linuxcnc/examples.
STOPPING = {"paper-trunnion": [3500, 3500, 3500, 500, 1000], "xyzac-trt": [400] * 5,
            "xyzbc-trt": [400] * 5}
REACTION_PERIODS = 2
CAUSE_CHANGED, CAUSE_PERSON = 5, 8
# Of the machine files; and of the comparison with LinuxCNC's kinematics.
PIVOT, TIP_LENGTH = {"xyzac-trt": (0, 20, 10), "xyzbc-trt": (-20, 0, -15)}, 30
TIP_ERROR_MM = 1e-3
TOOL_OF = {"paper-trunnion": 1, "xyzac-trt": 5, "xyzbc-trt": 5}
HEAD = "T1 M6\nG21 G90 G94\n"
# Into the plate (tests/can_vm/collide.ngc).
COLLIDE = HEAD + "G0 X20 Y50\nG0 X0 Y107.132 A-19.2 C97\nG0 Z-230\nM2\n"
# The same, slower and in a feed.
COLLIDE_FEED = HEAD + "G0 X20 Y50\nG0 X0 Y107.132 A-19.2 C97\nG1 Z-230 F3000\nM2\n"
# Long moves far from everything.
SWING = HEAD + "G0 X100 Y-80 Z40\nG0 X-100 Y80 A-20 C90\n" * 4 + "G0 X0 Y0 Z50 A0 C0\nM2\n"


# The tool of the collision stands about a millimetre above the plate. Down it may go on only as far
# as the guard's reach of a jog, and then not at all. The other way, another joint, or more speed
# than the machine file promises stop; up it comes out.
AFTER = HEAD + "G0 Z40\nG0 X100 Y-80 A0 C0\nM2\n"
UP = {"joint": 2, "way": 8, "speed": 4}
JOGS = [({"joint": 2, "way": -5, "speed": 4}, "stopped"),
        ({"joint": 2, "way": -1, "speed": 4}, "refused"), (UP | {"command": -1}, "stopped"),
        (UP | {"also": 0}, "stopped"), (UP | {"speed": 6}, "stopped"), (UP, "done")]
# The longer tool above, and the short one where only that one has room.
TOOLS = HEAD + "G0 X20 Y50\nT2 M6\nG0 X-20 Z-60\nG0 X20 Z40\nT1 M6\nG0 Z-220\nG0 Z40\nM2\n"


# With LinuxCNC's kinematics for the tool's tip: tilted above the plate, and into it.
TIP = "T5 M6\nG21 G90 G94\nG43 H5\nM428\nG1 X20 Y0 Z60 F1000\nG1 A-20 C45\nG1 X-10 Y15 Z20 C80\n"
TIP_CLEAN = TIP + "G1 X20 Y-10 Z40 A10\nM429\nM2\n"
TIP_COLLIDE = TIP + "G1 Z-5\nM429\nM2\n"


# LinuxCNC's own programs for its sample of this machine. They go down to the face of its rotary
# table, into the plate of ours; 60 mm higher they touch nothing.
DEMOS = pathlib.Path("/usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/vismach/5axis/"
                     "table-rotary-tilting/demos")


def demo(name, head=""):
    path = DEMOS / f"{name}.ngc"
    return head + path.read_text(encoding="ascii") if path.exists() else "M2\n"


def clean_program(source, lines):
    text = (source / "hil_replay/programs/paper-trunnion-clean.ngc").read_text(encoding="ascii")
    rows = text.strip().strip("%").strip().splitlines()
    return "\n".join(rows if lines is None else rows[:lines] + ["G0 Z50", "M2"]) + "\n"


# The table has the tool 20 mm longer than the machine file.
LENGTH_PROGRAM = HEAD + "G0 X20\nG43 H1\nG0 X-20\nM2\n"
LONGER = {"limit_s": 4, "length": True, "table": "T1 P1 Z160 D12\n",
          "after": HEAD + "G43 H1\nG0 X-20\nG0 X0\nM2\n"}


def scenarios(source):
    """name: (program, whether it is stopped, what happens meanwhile)."""
    kill = [{"do": "kill", "after_s": 1.5}]
    feed = [{"do": "feed", "after_s": 1.0, "value": 0.3}, {"do": "feed", "after_s": 2.5,
                                                          "value": 1.2}]
    return {
        "clean": (clean_program(source, 60), False, {}),
        "collide": (COLLIDE, True, {"again": True}),
        "collide_feed": (COLLIDE_FEED, True, {"events": [{"do": "feed", "after_s": 0.5,
                                                          "value": 1.3}]}),
        "collide_inch": (COLLIDE, True, {"is_inch": True}),
        "kill": (SWING, True, {"events": kill}),
        "kill_approach": (COLLIDE, True, {"events": [
            {"do": "kill", "pin": "axguard-stop.2.position", "below": -60}]}),
        "late": (SWING, True, {"events": [{"do": "late", "after_s": 1.5}]}),
        "feed": (SWING, False, {"events": feed}),
        "estop": (SWING, True, {"events": [{"do": "estop", "after_s": 1.2}], "again": True}),
        "estop_lag": (SWING, True, {"events": [{"do": "estop", "after_s": 1.2}], "again": True,
                                    "lags": True}),
        "unguarded": (COLLIDE, False, {}),
        "jog": (COLLIDE, True, {"jogs": [order for order, _ in JOGS], "after": AFTER}),
        "tool": (TOOLS, False, {}),
        "tool_collide": (TOOLS.replace("Z40\nT1 M6", "Z40"), True, {}),
        "tool_in_motion": (SWING, True, {"events": [{"do": "tool_change", "after_s": 1.5}]}),
        "tool_unknown": (TOOLS.replace("T2 M6", "T3 M6"), False,
                         {"limit_s": 5, "key": True, "after": AFTER}),
        "tool_length": (LENGTH_PROGRAM, False, LONGER),
        "tool_length_inch": (LENGTH_PROGRAM, False, LONGER | {"is_inch": True}),
        "xyzac_clean": (TIP_CLEAN, False, {}),
        "xyzac_collide": (TIP_COLLIDE, True, {}),
        "xyzbc_clean": (TIP_CLEAN.replace("A", "B"), False, {}),
        "xyzbc_collide": (TIP_COLLIDE.replace("A", "B"), True, {}),
        "home_key": (SWING, True, {"home_key": True, "events": [
            {"do": "unhome", "after_s": 1.5}]}),
        "gantry": (SWING, False, {"is_gantry": True}),
        "gantry_kill": (SWING, True, {"is_gantry": True, "events": kill}),
        "gantry_skew": (SWING, True, {"is_gantry": True, "skew": True, "again": True, "events": [
            {"do": "skew", "after_s": 1.5, "value": 0.12}]}),
        "clean_whole": (clean_program(source, None), False, {}),
        **{f"xyzac_demo_{n}": (demo(f"xyzac_switchkins_test_{n}"), True, {}) for n in (1, 2, 3)},
        **{f"xyzac_demo_{n}_raised":
           (demo(f"xyzac_switchkins_test_{n}", "G10 L2 P1 Z60\n"), False, {}) for n in (1, 2, 3)},
    }


# At most three minutes; the others run by hand, by name.
USUAL = ["clean", "collide", "collide_inch", "kill_approach", "late", "estop", "estop_lag",
         "unguarded", "jog", "tool", "tool_collide", "tool_unknown", "tool_length",
         "tool_length_inch", "xyzac_clean", "gantry_kill", "gantry_skew", "home_key"]
SAME_MM = 0.5  # between two runs of one collision: three periods of its speed


def tip_error(rows, machine):
    """How far LinuxCNC's live kinematics and the machine file differ, mm: while A or B tilts and C
    turns the tool's tip has to stay at X20 Y0 Z60 of the workpiece. And in how many periods."""
    worst, count = 0, 0
    px, py, pz = PIVOT[machine]
    for _, x, y, z, tilt_deg, c_deg, *_ in rows:
        if not (-19 < tilt_deg < -1 and 0 < c_deg < 45):
            continue
        tilt, c = math.radians(tilt_deg), math.radians(c_deg)
        x, y, z = x - px, y - py, z - TIP_LENGTH - pz
        if machine == "xyzac-trt":
            y, z = (math.cos(tilt) * y + math.sin(tilt) * z,
                    -math.sin(tilt) * y + math.cos(tilt) * z)
        else:
            x, z = (math.cos(tilt) * x - math.sin(tilt) * z,
                    math.sin(tilt) * x + math.cos(tilt) * z)
        x, y, z = x + px, y + py, z + pz
        x, y = math.cos(c) * x + math.sin(c) * y, -math.sin(c) * x + math.cos(c) * y
        worst, count = max(worst, math.dist((x, y, z), (20, 0, 60))), count + 1
    return worst, count


def stop_facts(rows, stopping, period_s=PERIOD_S):
    """Of each ramp: its periods beside the longest that the promise allows; the same from the
    sample at which the last permit was used; and whether a joint turned round."""
    ends = [i for i in range(2, len(rows)) if rows[i][7] and not rows[i - 1][7]]
    return [ramp_facts(rows, stopping, first, period_s) for first in ends]


def ramp_facts(rows, stopping, first, period_s):
    before = [rows[first - 1][1 + j] - rows[first - 2][1 + j] for j in range(5)]
    rest = first
    while rest < len(rows) and rows[rest][1:6] != rows[rest - 1][1:6]:
        rest += 1
    ramp = max(abs(step) / period_s / d for step, d in zip(before, stopping)) / period_s
    # While no permit comes, the time that is left falls by a period each period.
    used = first - 1
    while used > 0 and rows[used][8] < rows[used - 1][8]:
        used -= 1
    turned = any((rows[i][1 + j] - rows[i - 1][1 + j]) * before[j] < -1e-12
                 for i in range(first, rest) for j in range(5))
    left = rows[used][8] / 1e6 / period_s
    return {"at": rows[first][0], "turned": turned, "rest": rows[rest - 1][1:6],
            "speeds": [round(abs(step) / period_s, 1) for step in before],
            "periods": rest - first + 1, "promised": round(REACTION_PERIODS + ramp + 1, 1),
            "permit_left": round(left, 3), "from_last_permit": rest - used,
            "from_last_permit_promised": round(left + REACTION_PERIODS + ramp + 1, 1)}


def check_jogs(said):
    """Each jog ends as it has to, and a program runs afterwards."""
    jogs = said.get("jogs", [])
    ended, wanted = [jog.get("ended") for jog in jogs], [one for _, one in JOGS]
    faults = []
    if ended != wanted:
        return [f"jog: found {ended}, expected {wanted}"]
    if jogs[2]["to"] != jogs[2]["from"] or jogs[2]["cause"] != str(CAUSE_PERSON):
        faults.append(f"jog: moved against the selected way: {jogs[2]}")
    if abs(jogs[-1]["to"] - jogs[-1]["from"] - UP["way"]) > 1e-3:
        faults.append(f"jog: not where it was to end: {jogs[-1]}")
    withheld = "no permit here: not proven (predicted: cutter - c); jog another way"
    if withheld not in "\n".join(said["errors"]):
        faults.append(f"jog: the operator does not see why there is no permit: {said['errors']}")
    if said.get("after") != "done":
        faults.append(f"jog: the program afterwards: {said.get('after')}, expected done")
    return faults


KEY = {"armed_before": False, "changed_without_key": False, "waits": "TRUE",
       "jog_opens_chain": True, "moved": False, "chain_with_key_before": "FALSE", "on_again": True,
       "changed": True, "armed_with_key": False, "armed": True}
UNKNOWN = "tool 3 is not in paper-trunnion.yaml: add it under tools; load another tool to go on"


def check_key(said, output):
    """A person leads out of an unknown tool, and nothing else does."""
    faults = [f"tool_unknown: {key}: found {said.get('key', {}).get(key)}, expected {wanted}"
              for key, wanted in KEY.items() if said.get("key", {}).get(key) != wanted]
    if said.get("after") != "done":
        faults.append(f"tool_unknown: the program afterwards: {said.get('after')}, expected done")
    shown = "\n".join(said.get("errors", []))
    if UNKNOWN not in output or UNKNOWN not in shown:
        faults.append("tool_unknown: terminal or operator's message lack tool and way out")
    return faults


LENGTH = {"differs": "TRUE", "permit": "FALSE", "permit_without": True}


def check_length(said, unit_mm):
    """With another length in the tool table no joint moves, and both numbers are shown."""
    found = said.get("length", {})
    faults = [f"tool_length: {key}: found {found.get(key)}, expected {wanted}"
              for key, wanted in LENGTH.items() if found.get(key) != wanted]
    if abs(found.get("x", 0) * unit_mm - 20) > 1e-3:
        faults.append(f"tool_length: x: found {found.get('x')} of {unit_mm} mm, expected 20 mm")
    if said.get("after") != "done":
        faults.append(f"tool_length: the program afterwards: {said.get('after')}, expected done")
    if "length is 160.000 mm, length_mm of the machine file 140.000 mm" not in "".join(
            said.get("errors", [])):
        faults.append(f"tool_length: the operator does not see both: {said.get('errors')}")
    return faults


# Of a stop in the last motion of COLLIDE.
STOP_WORDS = ("stopped: verdict: predicted: cutter - c, program line 5\n",
              "mm apart, the proof of a stop needs up to ", "jog ", ": clearance at least ", "Z+")


def check_words(name, said, output, dumps):
    """LinuxCNC's operator and the terminal have the pair, the line, the distances and the way out;
    pair and clearance stay on the pins, the status has them, and a black box is dumped."""
    shown = "\n".join(said.get("errors", []))
    faults = [f"{name}: {where} lacks {words!r}" for words in STOP_WORDS
              for where, text in (("the operator's message", shown), ("the terminal", output))
              if words not in text.replace("\r\n", "\n")]
    status = said.get("status", {})
    if (status.get("program_line"), status.get("pair")) != (5, ["cutter", "c"]):
        faults.append(f"{name}: status: {status}")
    if "jog " not in str(status.get("way_out")) or "Z+" not in status["way_out"]:
        faults.append(f"{name}: status: no way out: {status}")
    if not dumps:
        faults.append(f"{name}: no dump of the black box")
    pins = said.get("pins", {})
    if any(pins[key] != value for key, value in said["pins_at_stop"].items()):
        faults.append(f"{name}: pins: found {pins}, expected {said['pins_at_stop']}")
    has, needed = (float(pins.get(f"axguard.{pin}-mm", -1)) for pin in ("clearance", "needed"))
    if not 0 < has < needed:
        faults.append(f"{name}: pins: clearance {has}, needed {needed}")
    return faults


def check(name, is_stopped, said, rows, overruns, judged, facts):
    faults = []
    if not said.get("homed") or not said.get("on"):
        return [f"{name}: LinuxCNC did not come up: {said}"]
    numbers = [row[0] for row in rows]
    lost = sum(b - a - 1 for a, b in zip(numbers, numbers[1:]) if b > a)
    if name != "unguarded" and (lost or overruns):
        faults.append(f"{name}: {lost} periods are missing in the record")
    if name == "unguarded":
        if not judged["stops"]:
            faults.append("unguarded: the judge saw no contact: it would see none elsewhere")
        return faults
    if not said["armed"] or "pins" not in said:
        return faults + [f"{name}: not armed"]
    waits = name == "tool_unknown" or name.startswith("tool_length")
    wanted = "stopped" if is_stopped else "limit" if waits else "done"
    if said["ended"] != wanted:
        faults.append(f"{name}: found {said['ended']}, expected {wanted}")
    if name == "tool_unknown":  # the judge knows no such tool either
        faults += [f"{name}: {stop}" for stop in judged["stops"] if stop["reason"] != "tool"]
        if any(one[1:6] != other[1:6] for one, other in zip(rows, rows[1:]) if other[10] == 3):
            faults.append(f"{name}: a joint moved with a tool that nobody knows")
    elif judged["stops"]:
        faults.append(f"{name}: contact: {judged['stops'][0]}")
    if name == "tool" and {row[10] for row in rows if row[6]} != {1, 2}:
        faults.append("tool: the samples had other tools than the program")
    is_estop = name.startswith("estop")
    if (is_stopped and not is_estop) != bool(facts):
        faults.append(f"{name}: {len(facts)} ramps in the record")
    for ramp in facts:
        if ramp["periods"] > ramp["promised"]:
            faults.append(f"{name}: {ramp['periods']} periods to standstill, promised "
                          f"{ramp['promised']:.1f}")
        if ramp["from_last_permit"] > ramp["from_last_permit_promised"]:
            faults.append(f"{name}: {ramp['from_last_permit']} periods from the last permit")
        if ramp["turned"]:
            faults.append(f"{name}: a joint turned round in the stop")
    if "kill" in name and said["pins"]["axguard-stop.cause"] != "3":
        faults.append(f"{name}: the stop has another cause than the end of the permit")
    if name in ("xyzac_clean", "xyzbc_clean"):
        worst, count = tip_error(rows, f"{name[:5]}-trt")
        print(f"{name}: live kinematics: {worst:.2e} mm off at most, {count} periods")
        if count < 1000 or worst > TIP_ERROR_MM:
            faults.append(f"{name}: LinuxCNC's kinematics are not those of the machine file")
    if name == "late" and said["pins"]["axguard-stop.cause"] != str(CAUSE_PERSON):
        faults.append("late: the stop has another cause than the late period")
    if name == "tool_in_motion" and said["pins"]["axguard-stop.cause"] != str(CAUSE_CHANGED):
        faults.append(f"{name}: the stop has another cause than the change of the tool")
    if name == "jog":
        faults += check_jogs(said)
    # A stop of LinuxCNC's own ends the permits, and is none of the guard.
    if is_estop and said["pins"]["axguard.phase"] not in ("2", "3"):
        faults.append(f"{name}: the guard stopped, or still permits: {said['pins']}")
    if is_estop:
        faults += check_frozen(name, said, rows)
    if name in ("collide", "estop", "estop_lag", "gantry_skew") and not said.get("on_again"):
        faults.append(f"{name}: not armed and switched on again after the stop")
    return faults


def check_frozen(name, said, rows):
    """Switched off, LinuxCNC commands what it measures; the joints stay where they were sent."""
    after = int(said["events"][0][1]) + 50
    steps = [abs(y - x) for one, other in zip(rows, rows[1:]) if one[0] > after
             for x, y in zip(one[1:6], other[1:6])]
    if len(steps) < 1000 or max(steps) > 1e-3:
        return [f"{name}: {len(steps)} steps after the E-stop, one of {max(steps, default=0)} mm"]
    return []


def check_record(name, place):
    """What axguard-hal records is a trace, from which inspect proposes limits for the machine."""
    answer = subprocess.run(  # a guard that was killed ended its last line anywhere
        [place.build / "axguard", "inspect", place.folder / "run.log", "--limits", "--lenient",
         "--machine", place.folder / f"{place.name}.yaml", "--json"], capture_output=True,
        text=True, check=False)
    if answer.returncode != 0:
        return [f"{name}: inspect: {answer.stdout[-500:]}{answer.stderr[-500:]}"]
    machine = json.loads(answer.stdout)["machine"]
    measured = machine["limits"]["X"]["acceleration"]["measured"]
    proposed = machine["proposed_limits"]["X"]["acceleration_mm_s2"]
    print(f"{name}: X: at most {measured} mm/s2 in {machine['snapshots']} samples: {proposed}")
    if machine["snapshots"] < 1000 or not 500 < measured < proposed:
        return [f"{name}: the record proposes {proposed} mm/s2 for {measured}"]
    return []


def check_gantry(name, said):
    """Both joints of Y go together, in a stop too; one that is too far off stops, by its name."""
    pins = said.get("pins", {})
    faults = [] if pins.get("axguard-stop.1.out") == pins.get("axguard-stop.2.out") else [
        f"{name}: the joints of Y rest apart: {pins}"]
    wanted = "TRUE" if name == "gantry_skew" else "FALSE"
    if pins.get("axguard-stop.skewed") != wanted:
        faults.append(f"{name}: skewed: found {pins.get('axguard-stop.skewed')}, expected {wanted}")
    if name != "gantry_skew":
        return faults
    if pins.get("axguard-stop.cause") != str(CAUSE_PERSON):
        faults.append(f"{name}: the stop has another cause than the skew")
    if said.get("armed_skewed") is not False or not said.get("on_again"):
        faults.append(f"{name}: armed while skewed, or not armed afterwards")
    if "joints 1 and 2 of one axis are 0.1200 apart, skew_mm allows 0.1000" not in "".join(
            said.get("errors", [])):
        faults.append(f"{name}: the operator does not see it: {said.get('errors')}")
    return faults


HOME = {"without": 0, "chain_without": "FALSE", "on_again": True, "with": 5}


def check_home(said):
    """The key lets a joint move from rest before it is homed; left turned, it opens nothing for a
    joint that loses its home in motion."""
    found = said.get("home", {})
    return [f"home_key: {key}: found {found.get(key)}, expected {wanted}"
            for key, wanted in HOME.items() if found.get(key) != wanted]


def check_units(facts_of):
    """The same machine in inch rests where the one in mm does."""
    if not {"collide", "collide_inch"} <= set(facts_of):
        return []
    rests = [facts_of[name]["stops"][0]["rest"] for name in ("collide", "collide_inch")
             if facts_of[name]["stops"]]
    if len(rests) == 2 and math.dist(*rests) <= SAME_MM:
        return []
    return [f"collide_inch: rests at {rests[-1:]}, expected {rests[:1]}"]


def run_all(given):
    # Not in a folder of root's own: LinuxCNC runs as somebody else.
    folder = given.keep or pathlib.Path(tempfile.mkdtemp(prefix="axg-linuxcnc-", dir="/tmp"))
    folder.mkdir(exist_ok=True)
    folder.chmod(0o755)
    faults, facts_of = [], {}
    for name in given.scenario or USUAL:
        program, is_stopped, more = scenarios(given.source)[name]
        machine = f"{name[:5]}-trt" if name.startswith("xyz") else "paper-trunnion"
        place = Place(folder / name, given.source, given.build, machine)
        guarded = name != "unguarded"
        place.prepare(program, guarded, given.simulation_wait_us,
                      **{"limit_s": given.limit_s, **more})
        said, output = place.run(given.limit_s + 40)
        if not said:
            print(output)
            faults.append(f"{name}: LinuxCNC did not start")
            continue
        rows, overruns = place.samples()
        # Before they are homed nobody knows where the joints are.
        armed = next((i for i, row in enumerate(rows) if row[6]), 0)
        judged = contacts_of([row[1:6] for row in rows[armed:]],
                             [row[10] if guarded else TOOL_OF[machine] for row in rows[armed:]],
                             [guarded and row[9] == 2 for row in rows[armed:]],
                             place.folder / f"{machine}.yaml", place.folder, place.folder,
                             given.build / "axguard")
        facts = stop_facts(rows, STOPPING[machine])
        mine = check(name, is_stopped, said, rows, overruns, judged, facts)
        mine += check_key(said, output) if name == "tool_unknown" else []
        mine += check_length(said, place.unit_mm) if name.startswith("tool_length") else []
        if name == "collide":
            mine += check_words(name, said, output, list(place.folder.glob("linuxcnc-*.axgbox")))
        mine += check_record(name, place) if name == "gantry_kill" else []
        mine += check_home(said) if name == "home_key" else []
        mine += check_gantry(name, said) if name.startswith("gantry") else []
        facts_of[name] = {"samples": len(rows), "overruns": overruns, "ended": said.get("ended"),
                          "contacts": sum(stop["reason"] != "tool" for stop in judged["stops"]),
                          "stops": facts, "resumed": said.get("resumed", 0),
                          "tools": sorted({row[10] for row in rows}), "jogs": said.get("jogs"),
                          "key": said.get("key"),
                          "after": said.get("after"),
                          "pins": said.get("pins"), "errors": said.get("errors")}
        print(json.dumps({name: facts_of[name]}))
        print("\n".join(line for line in output.splitlines() if "axguard" in line))
        if mine:
            print("\n".join(mine), output[-3000:], sep="\n")
        faults += mine
    if not given.keep:
        shutil.rmtree(folder, ignore_errors=True)
    return faults + check_units(facts_of), facts_of


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("scenario", nargs="*")
    parser.add_argument("--simulation-wait-us", type=int, default=400000)
    parser.add_argument("--record", type=pathlib.Path)
    parser.add_argument("--limit-s", type=float, default=60)
    parser.add_argument("--keep", type=pathlib.Path)
    given = parser.parse_args()
    for file in ("axguard", "axguard-hal", "axguard_stop.so"):
        if not (given.build / file).exists():
            print(f"skipped: {file} is not built (apt install linuxcnc-uspace-dev)")
            return SKIPPED
    if shutil.which("linuxcnc") is None:
        print("skipped: no linuxcnc (apt install linuxcnc-uspace)")
        return SKIPPED
    try:
        with module(given.build):
            faults, facts_of = run_all(given)
    except NotPossible as what:
        print(f"skipped: {what}")
        return SKIPPED
    if given.record:
        given.record.write_text(json.dumps(facts_of, indent=1), encoding="utf-8")
    print("\n".join(faults) if faults else "ok")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
