#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The DISPLAY program of a LinuxCNC that has none: homes, arms the guard, runs a program and does
what the scenario wants meanwhile. Writes result.json."""
import json
import math
import os
import signal
import socket
import subprocess
import sys
import time

import linuxcnc

SCENARIO = json.load(open("scenario.json", encoding="utf-8"))
COMMAND, STAT, ERRORS = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
RESULT = {"errors": [], "armed": False, "ended": "", "events": []}


def pin(name):
    return subprocess.run(["halcmd", "getp", name], capture_output=True, text=True,
                          check=False).stdout.strip()


def set_pin(name, value):
    subprocess.run(["halcmd", "setp", name, str(value)], check=True)


def poll():
    STAT.poll()
    while True:
        error = ERRORS.poll()
        if not error:
            return
        RESULT["errors"].append(error[1])


def until(condition, seconds):
    end = time.time() + seconds
    while time.time() < end:
        poll()
        if condition():
            return True
        time.sleep(0.02)
    return False


def switch_on():
    COMMAND.state(linuxcnc.STATE_ESTOP_RESET)
    COMMAND.wait_complete()
    COMMAND.state(linuxcnc.STATE_ON)
    COMMAND.wait_complete()
    COMMAND.mode(linuxcnc.MODE_MANUAL)
    COMMAND.wait_complete()
    return until(lambda: STAT.task_state == linuxcnc.STATE_ON, 5)


def home():
    COMMAND.teleop_enable(0)
    COMMAND.wait_complete()
    for joint in range(STAT.joints):
        COMMAND.home(joint)
    return until(lambda: all(STAT.homed[:STAT.joints]), 10)


def jog_unhomed():
    """Five millimetres of joint 0, before it is homed."""
    COMMAND.teleop_enable(0)
    COMMAND.wait_complete()
    COMMAND.jog(linuxcnc.JOG_INCREMENT, True, 0, 20, 5)
    until(lambda: STAT.task_state != linuxcnc.STATE_ON
          or abs(float(pin("axguard-stop.0.out")) - 5) < 1e-3, 5)
    return float(pin("axguard-stop.0.out"))


def move_by_key():
    """Before joints are homed a motion opens the E-stop chain. The turn of the key closes it again,
    and a joint may move."""
    said = {"without": jog_unhomed(), "chain_without": pin("axguard-stop.estop-ok")}
    set_pin("axguard-stop.home-unguarded", 1)
    time.sleep(0.1)
    said["on_again"] = switch_on()
    said["with"] = round(jog_unhomed(), 3)
    return said


def arm():
    set_pin("axguard-stop.arm", 0)
    time.sleep(0.05)
    set_pin("axguard-stop.arm", 1)
    is_armed = until(lambda: pin("axguard-stop.permit-ok") == "TRUE", 7)
    set_pin("axguard-stop.arm", 0)
    return is_armed


def run_program(name):
    COMMAND.mode(linuxcnc.MODE_AUTO)
    COMMAND.wait_complete()
    COMMAND.program_open(os.path.join(os.getcwd(), name))
    COMMAND.wait_complete()
    COMMAND.auto(linuxcnc.AUTO_RUN, 0)
    began = time.time()
    events = list(SCENARIO.get("events", []))
    time.sleep(0.3)
    while time.time() - began < SCENARIO["limit_s"]:
        poll()
        while events and is_due(events[0], began):
            act(events.pop(0))
        if STAT.task_state != linuxcnc.STATE_ON:
            return "stopped"
        if STAT.interp_state == linuxcnc.INTERP_PAUSED and STAT.inpos:  # M0 or M1
            RESULT["resumed"] = RESULT.get("resumed", 0) + 1
            COMMAND.auto(linuxcnc.AUTO_RESUME)
            time.sleep(0.1)
        if STAT.interp_state == linuxcnc.INTERP_IDLE and STAT.inpos:
            return "done"
        time.sleep(0.02)
    return "limit"


def jog(order):
    """By the guard's permit: a person selects joint and way, arms, switches on, and jogs. Says what
    became of it: refused (the guard does not become ready), stopped, or done."""
    RESULT["jogs"].append(said := {"joint": order["joint"], "way": order["way"]})
    set_pin("axguard-stop.jog-joint", order["joint"])
    set_pin("axguard-stop.jog-down", int(order["way"] < 0))
    set_pin("axguard-stop.jog", 1)
    time.sleep(0.3)
    position = f"axguard-stop.{order['joint']}.position"
    said.update({"from": float(pin(position)), "clearance": float(pin("axguard.clearance-mm"))})
    if not arm():
        return said.update(ended="refused", proven=pin("axguard.proven"))
    switch_on()
    COMMAND.teleop_enable(0)
    COMMAND.wait_complete()
    poll()
    command = order.get("command", order["way"])
    COMMAND.jog(linuxcnc.JOG_INCREMENT, True, order["joint"],
                math.copysign(order["speed"], command), abs(command))
    if "also" in order:  # a joint that was not selected
        COMMAND.jog(linuxcnc.JOG_INCREMENT, True, order["also"], 1, 1)
    wanted = said["from"] + order["way"]
    is_there = until(lambda: STAT.task_state != linuxcnc.STATE_ON
                     or abs(float(pin(position)) - wanted) < 1e-3, 20)
    time.sleep(0.3)
    poll()
    said["to"] = float(pin(position))
    is_on = STAT.task_state == linuxcnc.STATE_ON
    return said.update(ended="done" if is_there and is_on else "stopped",
                       cause=pin("axguard-stop.cause"))


def jog_out():
    """Jogs, and then the program of after.ngc, for which no jog is selected."""
    RESULT["jogs"] = []
    for order in SCENARIO["jogs"]:
        jog(order)
    set_pin("axguard-stop.jog", 0)
    if until(lambda: pin("axguard-stop.permit-ok") == "TRUE", 2):
        RESULT["after"] = run_program("after.ngc")


def turn_key(value):
    set_pin("axguard-stop.change-unguarded", value)
    time.sleep(0.1)


def change_to_known_tool():
    """After an aborted change LinuxCNC believes that the tool before is in the spindle."""
    COMMAND.mode(linuxcnc.MODE_MDI)
    COMMAND.wait_complete()
    COMMAND.mdi("M61 Q3")
    COMMAND.wait_complete()
    COMMAND.mdi("T1 M6")
    return until(lambda: pin("axguard-stop.tool") == "1", 2)


def change_by_key():
    """A person leads out of a stop with an unknown tool. Without the key the change waits; with it
    no joint moves, and a jog opens the E-stop chain; then another tool is loaded, and a program
    runs."""
    RESULT["key"] = said = {"armed_before": arm()}
    COMMAND.abort()
    said["changed_without_key"] = change_to_known_tool()
    said["waits"] = pin("axguard-stop.tool-change")
    COMMAND.abort()
    COMMAND.mode(linuxcnc.MODE_MANUAL)
    COMMAND.wait_complete()
    turn_key(1)
    before = pin("axguard-stop.2.position")
    COMMAND.teleop_enable(0)
    COMMAND.wait_complete()
    COMMAND.jog(linuxcnc.JOG_INCREMENT, True, 2, 5, 5)
    said["jog_opens_chain"] = until(lambda: STAT.task_state != linuxcnc.STATE_ON, 3)
    said["moved"] = pin("axguard-stop.2.position") != before
    said["chain_with_key_before"] = pin("axguard-stop.estop-ok")
    turn_key(0)
    turn_key(1)
    said["on_again"] = switch_on()
    said["changed"] = change_to_known_tool()
    said["armed_with_key"] = arm()
    turn_key(0)
    said["armed"] = arm()
    until(lambda: STAT.interp_state == linuxcnc.INTERP_IDLE, 3)
    RESULT["after"] = run_program("after.ngc")


def correct_length():
    """The tool table had another length; without one, and with the right one, programs run."""
    RESULT["length"] = said = {"differs": pin("axguard-stop.tool-length-differs"),
                               "permit": pin("axguard-stop.permit-ok"),
                               "x": float(pin("axguard-stop.0.position"))}
    COMMAND.abort()
    COMMAND.mode(linuxcnc.MODE_MDI)
    COMMAND.wait_complete()
    COMMAND.mdi("G49")
    said["permit_without"] = until(lambda: pin("axguard-stop.permit-ok") == "TRUE", 2)
    COMMAND.mdi("G10 L1 P1 Z140")
    COMMAND.wait_complete()
    RESULT["after"] = run_program("after.ngc")


def is_due(event, began):
    """After so many seconds, or when a pin has fallen below a value."""
    if "pin" in event:
        return float(pin(event["pin"])) < event["below"]
    return time.time() - began >= event["after_s"]


def guard_process():
    line = subprocess.run(["halcmd", "-s", "show", "comp", "axguard-hal"], capture_output=True,
                          text=True, check=True).stdout.split()
    return int(line[line.index("axguard-hal") + 1])


def act(event):
    RESULT["events"].append([event["do"], pin("axguard-stop.sample")])
    if event["do"] == "kill":  # the guard, which can tell nobody
        os.kill(guard_process(), signal.SIGKILL)
    elif event["do"] == "late":  # the servo thread waits, and meanwhile it becomes a real one
        guard = guard_process()
        os.kill(guard, signal.SIGSTOP)
        time.sleep(0.1)
        set_pin("axguard-stop.simulation-wait-us", 0)
        time.sleep(0.6)
        os.kill(guard, signal.SIGCONT)
    elif event["do"] == "estop":  # LinuxCNC's own: the command freezes
        COMMAND.state(linuxcnc.STATE_ESTOP)
    elif event["do"] == "inhibit":
        subprocess.run(["halcmd", "sets", "inhibit", "1"], check=True)
    elif event["do"] == "tool_change":  # in motion, and announced by nobody
        subprocess.run(["halcmd", "unlinkp", "axguard-stop.tool-change"], check=True)
        set_pin("axguard-stop.tool-change", 1)
    elif event["do"] == "unhome":  # one joint, in motion
        subprocess.run(["halcmd", "unlinkp", "axguard-stop.0.homed"], check=True)
        set_pin("axguard-stop.0.homed", 0)
    elif event["do"] == "skew":  # of one joint of a gantry
        subprocess.run(["halcmd", "unlinkp", "axguard-stop.2.offset"], check=True)
        set_pin("axguard-stop.2.offset", event["value"])
    elif event["do"] == "feed":
        COMMAND.feedrate(event["value"])


STOP_PINS = ("axguard.pair", "axguard.clearance-mm", "axguard.needed-mm")


def status():
    """What the guard's status socket sends."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as reader:
        reader.settimeout(5)
        try:
            reader.connect("axguard.status")
        except OSError:  # the guard was killed
            return {}
        text = b""
        while part := reader.recv(4096):
            text += part
    return json.loads(text)


def main():
    time.sleep(1)
    poll()
    try:
        RESULT["on"] = switch_on()
        if SCENARIO.get("home_key"):  # and it stays turned
            RESULT["home"] = move_by_key()
        RESULT["homed"] = home()
        if SCENARIO["guarded"]:
            RESULT["armed"] = arm()
        if RESULT["armed"] or not SCENARIO["guarded"]:
            RESULT["ended"] = run_program("program.ngc")
        if RESULT["ended"] == "stopped" and SCENARIO["guarded"]:
            RESULT["pins_at_stop"] = {name: pin(name) for name in STOP_PINS}
            time.sleep(0.3)  # at rest, what leads out is known
            RESULT["status"] = status()
        if RESULT["ended"] == "stopped" and "jogs" in SCENARIO:
            jog_out()
        if RESULT["ended"] == "limit" and "length" in SCENARIO:
            correct_length()
        if RESULT["ended"] == "limit" and "key" in SCENARIO:
            change_by_key()
        time.sleep(0.3)
        poll()
        if SCENARIO["guarded"]:
            RESULT["pins"] = {name: pin(name) for name in (
                "axguard-stop.cause", "axguard-stop.permits", "axguard-stop.last-stop-periods",
                "axguard-stop.simulation-unheard", "axguard.late", "axguard.samples-lost",
                "axguard.stops", "axguard-stop.late-periods", "axguard-stop.refusal",
                "axguard-stop.estop-ok", *STOP_PINS, "axguard.phase",
                "axguard-stop.skewed", "axguard-stop.1.out", "axguard-stop.2.out")}
        if SCENARIO.get("skew") and RESULT["ended"] == "stopped":
            RESULT["armed_skewed"] = arm()
            set_pin("axguard-stop.2.offset", 0)
        if SCENARIO.get("again"):
            RESULT["on_again"] = arm() and switch_on()
    finally:
        with open("result.json", "w", encoding="utf-8") as file:
            json.dump(RESULT, file, indent=1)
    sys.exit(0)


main()
