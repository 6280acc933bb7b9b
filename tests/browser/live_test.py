#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The page of `axguard watch` in headless Chromium, with a status socket of the test's own and a
recorded bus: the machine moves as its samples say, each state of the guard is in words, a stop is
announced, it fits three sizes of screen, its texts can be read, the keyboard reaches all of it, and
it says so when the guard or the server is gone. With a file as third argument the first screen is
stored there as a picture, and with one as fourth that of a stop."""
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

from browser import ActionChains, Keys, browser_or_exit, resize, small_targets
from report_test import SIZES, TEXT_CONTRAST, run, text_contrasts

# Moves at once, stays where the guard permits it.
PROGRAM = "T1 M6\nG0 X5\n" + "G1 F2000 X40 Y30\nG1 X-40 Y-20 Z-60\n" * 8 + "M2\n"
SECONDS = 45.0  # of the trace: longer than a busy machine takes to come to its end
LEAST_RATE = 5  # events a second that a busy machine still shows

# Of a stop: the guard's keys, with figures that are all different.
WHY = {"needed_mm": 7.013, "available_mm": 6.5, "within_mm": 50.0, "to_standstill_mm": None,
       "until_braking_mm": 1.25, "braking_mm": 3.5, "position_error_mm": 0.0125,
       "speed_uncertainty_mm": 0.25, "margin_mm": 2.0, "arithmetic_mm": 0.0005,
       "list_full": False, "jog": False, "tool": 1,
       "open": {"needed_mm": 3.0, "available_mm": 2.75}}

faults = []


def check(is_true, what):
    if not is_true:
        faults.append(what)


class FakeGuard:
    """A status socket whose line the test sets; None: nobody serves it."""

    def __init__(self, path):
        self.path, self.line, self.server = path, None, None

    def say(self, **changes):
        self.line = {**self.line, **changes}
        if self.server is None:
            self.path.unlink(missing_ok=True)
            self.server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self.server.bind(str(self.path))
            self.server.listen()
            threading.Thread(target=self.serve, args=[self.server], daemon=True).start()

    def serve(self, server):
        try:
            while True:
                reader, _ = server.accept()
                reader.sendall(json.dumps(self.line).encode() + b"\n")
                reader.close()
        except OSError:
            pass  # the test closed it

    def end(self):
        self.server.shutdown(socket.SHUT_RDWR)
        self.server.close()
        self.server = None
        self.path.unlink()


def line_of(configuration):
    counters = ("snapshots", "permits", "permits_slow", "stop_frames", "late", "refused",
                "send_faults", "samples_lost", "frames_dropped", "operator_acts",
                "operator_refused", "operator_ignored")
    return {"axguardd": "0.1.0", "bus": "can0", "machine": "paper-trunnion",
            "file": "paper-trunnion.yaml", "configuration_sha256": configuration,
            "mode": "stoppable",
            "board_test": {"record": "none", "serial": None, "date": None, "differs": []},
            "sample_us": 4000, "period_us": None, "age_ms": 1,
            "phase": "ready", "phase_ms": 1200, "cause": "none", "reason": "none", "pair": None,
            "why": None, "program_line": None, "unknown_tool": None, "way_out": None,
            "withheld": "nothing", "withheld_reason": "none", "withheld_pair": None,
            "withheld_why": None, "tool": 1, "guarded_tool": 1, "stands": True,
            "confirmed": False, "session": True, "hashes": "required",
            **{name: 7 for name in counters}}


def stamp(line):
    return float(line[1:line.index(")")])


def recorded_bus(folder, axguard, machine, meshes):
    """Board and guard in one log, its first seconds."""
    program, trace, guard = folder / "p.ngc", folder / "board.log", folder / "guard.log"
    program.write_text(PROGRAM)
    run([0], axguard, "simulate", machine, program, "-o", trace, *meshes)
    run([0, 10], axguard, "replay", machine, trace, "--frames-out", guard, *meshes)
    lines = [line for path in (trace, guard) for line in path.read_text().splitlines(True)
             if line.startswith("(")]
    lines.sort(key=stamp)
    both = folder / "both.log"
    device = re.compile(r" \S+ ")
    both.write_text("".join(device.sub(" can0 ", line, count=1) for line in lines
                            if stamp(line) < stamp(lines[0]) + SECONDS))
    return both


class Watch:
    def __init__(self, *words):
        self.process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        line = self.process.stderr.readline()
        if " at http://" not in line:
            sys.exit(f"axguard watch: {line}{self.process.stderr.read()}")
        self.url = line.split(" at ")[1].split(";")[0]

    def end(self):
        self.process.send_signal(signal.SIGINT)
        check(self.process.wait(10) == 0, f"SIGINT: ended with {self.process.returncode}")


def wait_for(browser, script, what, seconds=15):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if browser.execute_script(f"return Boolean({script})"):
            return True
        time.sleep(0.1)
    check(False, f"{what}; shown: {browser.find_element('tag name', 'body').text[:400]}")
    return False


def headline_is(browser, kind, words):
    return wait_for(browser, f"document.getElementById('header').className === '{kind}' && "
                    f"document.getElementById('headline').textContent.includes({words!r})",
                    f"{kind}: {words!r} is not shown")


def check_moves(browser):
    """The machine is drawn where the samples say, and permits and hints are in words."""
    wait_for(browser, "axguard.state && axguard.state.axes && axguard.events > 3", "no positions")
    first = browser.execute_script("return axguard.positions")
    wait_for(browser, f"JSON.stringify(axguard.positions) !== {json.dumps(json.dumps(first))}"
             ".replaceAll(' ', '')", "the machine does not move")
    drawn, shown, state = browser.execute_script("""
        const element = axguard.view.bodies[1].matrix.elements;
        return [element, axguard.positions, axguard.state.axes.positions];""")
    check(len(drawn) == 16 and len(shown) == 5 and len(state) == 5, f"axes: {shown}")
    wait_for(browser, "axguard.state.permit && axguard.state.permit.in_force", "no permit in force")
    words = browser.find_element("id", "permit").text
    check("valid" in words and "cap" in words and "level" in words, f"permit: {words}")
    wait_for(browser, "axguard.state.hints && axguard.state.hints.name", "no nearest pair")
    check(" mm" in browser.find_element("id", "clearance").text, "no clearance")


def check_states(browser, guard):
    """Each state in words, and what a screen reader is told."""
    guard.say(phase="armed", phase_ms=100)
    headline_is(browser, "armed", "Armed")
    check("may move" in browser.find_element("id", "plain").text, "armed, in no plain words")
    news = browser.find_element("id", "news")
    check(news.get_attribute("textContent") == "Armed" and news.get_attribute("role") == "status",
          "a change of phase is not announced")
    guard.say(phase="stopped", cause="verdict", reason="contact", pair=["cutter", "c"])
    headline_is(browser, "stopped", "STOP: verdict: contact: cutter - c")
    alarm = browser.find_element("id", "alarm")
    check(alarm.get_attribute("textContent").startswith("STOP") and
          alarm.get_attribute("role") == "alert", "a stop is not announced at once")
    check(browser.title.startswith("STOP"), f"title: {browser.title}")
    check(browser.find_element("id", "mark").text != "", "a state without a mark beside its colour")
    guard.say(configuration_sha256="f" * 64)
    wait_for(browser, "document.getElementById('notes').textContent.includes("
             "'Another machine file')", "another machine file is not said")
    guard.say(machine="<img src=x onerror=alert(1)>")
    time.sleep(0.5)
    check(not browser.find_elements("css selector", "#notes img"), "foreign text became markup")
    guard.line["phase"] = "???"
    wait_for(browser, "document.getElementById('notes').textContent.includes('no status of this')",
             "garbage on the socket is not said")
    guard.end()
    wait_for(browser, "document.getElementById('notes').textContent.includes('no guard')",
             "a guard that has ended is not said")


def check_why(browser, guard, picture):
    """Needed and available distance with their parts, hidden while nothing is withheld."""
    section = browser.find_element("id", "why_section")
    check(not section.is_displayed(), "a reason is shown while nothing is withheld")
    guard.say(phase="stopped", cause="verdict", reason="predicted", pair=["cutter", "c"], why=WHY,
              way_out="jog Z+ (1 mm: clearance at least 7.5000 mm)")
    wait_for(browser, "document.getElementById('why').children.length > 6", "no reason of the stop")
    words = browser.find_element("id", "why").text
    for part in ("cutter - c, tool 1", "7.0130 mm", "6.5000 mm", "motion until braking", "braking",
                 "uncertainty of position", "uncertainty of speed", "margin to keep", "arithmetic",
                 "needs 3.0000 mm and has 2.7500 mm", "way out",
                 "jog Z+ (1 mm: clearance at least 7.5000 mm)"):
        check(part in words, f"why: {part!r} is not in {words!r}")
    check("standstill" not in words and "null" not in words, f"why: {words!r}")
    if picture:
        resize(browser, 1200, 800)
        browser.save_screenshot(picture)
    check_sizes(browser)
    guard.say(phase="selftest", cause="none", reason="none", pair=None, why=None,
              way_out=None,
              withheld="not proven", withheld_reason="predicted", withheld_pair=["cutter", "c"],
              withheld_why={**WHY, "available_mm": 50.0, "list_full": True})
    wait_for(browser, "document.getElementById('why').textContent.includes('permit withheld')",
             "no reason of the withheld permit")
    words = browser.find_element("id", "why").text
    check("at least 50.0000 mm" in words and "a list was full" in words, f"why: {words!r}")
    guard.say(withheld_why=None)
    wait_for(browser, "document.getElementById('why').textContent.includes('not known')",
             "a distance that is not known is not said to be")
    check(" mm" not in browser.find_element("id", "why").text, "a figure that is not known")
    guard.say(withheld="nothing", withheld_reason="none", withheld_pair=None, phase="armed")
    wait_for(browser, "document.getElementById('why_section').hidden", "the reason stays")


def check_sizes(browser):
    for width, height in SIZES:
        resize(browser, width, height)
        wide, outside, small = browser.execute_script("""
            const box = (e) => e.getBoundingClientRect();
            const all = [...document.querySelectorAll("header *, main *")]
              .filter((e) => e.offsetParent !== null && box(e).width > 0);
            return [document.documentElement.scrollWidth - window.innerWidth,
              all.filter((e) => box(e).right > window.innerWidth + 1 || box(e).left < -1)
                .map((e) => e.id || e.tagName),
              box(document.getElementById("machine")).width];""")
        check(wide <= 0 and not outside, f"{width} px: {wide} px too wide, outside: {outside}")
        check(small >= min(250, width - 40), f"{width} px: a view of {small} px")
        missed = small_targets(browser)
        check(not missed, f"{width} px: too small for a finger: {missed}")
    resize(browser)


def check_texts(browser):
    for kind in ("armed", "ready", "selftest", "init", "running", "stopped", "unreachable"):
        browser.execute_script(f"document.getElementById('header').className = '{kind}'")
        texts = text_contrasts(browser)
        check(len(texts) > 15, f"only {len(texts)} texts to look at")
        for name, ratio in texts:
            check(ratio >= TEXT_CONTRAST, f"{kind}: text of {name}: contrast {ratio:.2f}")


def check_keys(browser):
    """Tab goes to the button and to every check box, and shows where it is."""
    browser.execute_script("document.activeElement.blur()")
    seen = []
    for _ in range(12):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        seen.append(browser.execute_script(
            "const e = document.activeElement; return [e.id || e.tagName, "
            "getComputedStyle(e).outlineStyle]"))
    names = [name for name, _ in seen]
    check("whole" in names and "INPUT" in names, f"Tab reaches {names}")
    check(all(style != "none" for name, style in seen if name in ("whole", "INPUT")),
          f"focus is not seen: {seen}")
    ActionChains(browser).send_keys("f").perform()


def check_rate(browser):
    before = browser.execute_script("return axguard.events")
    time.sleep(3)
    rate = (browser.execute_script("return axguard.events") - before) / 3
    check(rate >= LEAST_RATE, f"{rate:.1f} events a second")
    return rate


def main():
    root, axguard = pathlib.Path(sys.argv[1]), sys.argv[2]
    shipped = root / "config/machines/paper-trunnion.yaml"
    browser = browser_or_exit()
    try:
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            # Levels that reach far: the hints then have a pair at every position.
            machine = folder / "machine.yaml"
            machine.write_text(shipped.read_text(encoding="utf-8").replace(
                "margin_mm: 0", "margin_mm: 0, slow_mm: 5, warn_mm: 300")
                + "  sample_us: 4000\n", encoding="utf-8")  # `can` is the file's last section
            meshes = ("--mesh-root", shipped.parent)
            trace = recorded_bus(folder, axguard, machine, meshes)
            checked = json.loads(run([0], axguard, "check", machine, "--json", *meshes))
            guard = FakeGuard(folder / "status")
            guard.line = line_of(checked["configuration_sha256"])
            guard.say()
            words = [axguard, "watch", machine, *meshes, "--trace", trace, "--socket",
                     guard.path, "--listen"]
            watch = Watch(*words, "127.0.0.1:0")
            browser.get(watch.url)
            wait_for(browser, "window.axguard !== undefined", "the page did not load")
            check(browser.execute_script("return axguard.view !== null"), "no view of the machine")
            headline_is(browser, "ready", "Ready to be armed")
            check_moves(browser)
            guard.say(phase="armed")
            headline_is(browser, "armed", "Armed")
            if len(sys.argv) > 3:
                resize(browser, 1200, 800)
                browser.execute_script("axguard.showWhole()")
                browser.save_screenshot(sys.argv[3])
            check_sizes(browser)
            check_keys(browser)
            rate = check_rate(browser)
            check_why(browser, guard, sys.argv[4] if len(sys.argv) > 4 else None)
            check_states(browser, guard)
            check_texts(browser)
            errors = [line["message"] for line in browser.get_log("browser")
                      if line["level"] == "SEVERE"]
            check(not errors, f"the console says {errors}")
            watch.end()
            headline_is(browser, "unreachable", "axguard watch does not answer")
            again = Watch(*words, watch.url.removeprefix("http://").rstrip("/"))
            wait_for(browser, "axguard.state && document.getElementById('headline').textContent"
                     " !== 'axguard watch does not answer'", "the page does not come back")
            again.end()
    finally:
        browser.quit()
    for fault in faults[:20]:
        print(fault)
    print(f"{len(faults)} faults; {rate:.1f} events a second")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
