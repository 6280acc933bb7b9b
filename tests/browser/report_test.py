#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The page of `replay`, `drive` and `check --report` in headless Chromium: it loads from disk with
no error, the slider and the keys move the machine, it plays, its stop is where table and results
say, the line between the nearest triangles is as long as the clearance that was certified, the
program's line is that of the shown time, it fits three sizes of screen, and what is drawn can be
read and told apart."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import time

from browser import ActionChains, Keys, browser_or_exit, resize, small_targets, touch

LINE_MM = 2e-3  # positions of rows are written to seven digits

SIZES = ((390, 844), (1024, 768), (1920, 1080))
TEXT_CONTRAST, MARK_CONTRAST = 4.5, 3.0  # WCAG 2.2, 1.4.3 and 1.4.11
PAIRS = 15  # curves that must differ without their colours

faults = []


def check(is_true, what):
    if not is_true:
        faults.append(what)


def run(wanted, *words):
    """Standard output; ends the test where the exit code is another one."""
    done = subprocess.run(words, stdout=subprocess.PIPE, check=False, text=True)
    if done.returncode not in wanted:
        sys.exit(f"{' '.join(map(str, words))}: ended with {done.returncode}, wanted {wanted}")
    return done.stdout


def look(browser, path):
    browser.get(path.as_uri())
    errors = [line["message"] for line in browser.get_log("browser") if line["level"] == "SEVERE"]
    check(not errors, f"{path.name}: the console says {errors}")
    check(browser.execute_script("return window.axguard !== undefined && axguard.view !== null"),
          f"{path.name}: no page, or no view of the machine")


def time_of(browser):
    return browser.execute_script("return axguard.time")


def check_stop(browser, results, table):
    """The page opens at the stop; the table's last sample is the same."""
    stop = results["stops"][0]
    check(abs(time_of(browser) - stop["time_us"] * 1e-6) < 1e-6, "it does not open at the stop")
    last = table[-1]
    check(int(last["arrived_us"]) == stop["time_us"], "the table's last sample is not the stop")
    names = [name for name in last if name in stop["axes"]]
    check(len(names) == 5, f"axes of the table: {names}")
    shown = browser.execute_script("return axguard.positions")
    for name, position in zip(names, shown):
        check(abs(position - float(last[name])) < 1e-5, f"{name}: {position}, table {last[name]}")
    headline = browser.find_element("id", "headline").text
    why = browser.execute_script("return axguard.stops[0].why.sentences[0]")
    check(headline.startswith("STOP at ") and why in headline, f"headline: {headline}")


def check_touching(browser, results):
    """In contact mode the triangles that touch are drawn."""
    pairs = results["stops"][0]["pairs"]
    drawn = browser.execute_script("return axguard.view.marked.children.length")
    wanted = sum(len({ids[side] for ids in pair["triangles"]})
                 for pair in pairs for side in (0, 1))
    check(wanted > 0 and drawn >= wanted, f"{drawn} marks, wanted at least {wanted}")


def check_why(browser, results, mode):
    """Figures of the stop are in the table; in stoppable mode both bodies lie in their boxes."""
    why = results["stops"][0]["why"]
    rows = browser.execute_script("return document.getElementById('why_parts').innerText")
    for key in ("needed_mm", "available_mm"):
        check(f"{why[key]:.4f} mm" in rows, f"{mode}: no {key} in {rows}")
    check(why["pair"] in browser.find_element("id", "why_sum").text, f"{mode}: why without a pair")
    for sentence in browser.execute_script("return axguard.stops[0].why.sentences"):
        check(sentence in browser.find_element("id", "why_sum").text, f"{mode}: no {sentence!r}")
    boxes, outside, hidden = browser.execute_script("""
        const view = axguard.view, stop = axguard.stops[0], boxes = stop.why.reach_bodies || [];
        let outside = 0;
        for (const {body, low_mm, high_mm, placed} of boxes) {
          const i = axguard.data.machine.bodies.findIndex((one) => one.name === body);
          const [mesh, at] = view.surfaceOf(i);
          const back = new THREE.Matrix4().getInverse(matrixOf(placed)).multiply(at);
          for (let k = 0; k < mesh.points.length; k += 3) {
            const p = new THREE.Vector3(...mesh.points.slice(k, k + 3)).applyMatrix4(back);
            outside += ["x", "y", "z"].some((c, n) => p[c] < low_mm[n] || p[c] > high_mm[n]);
          }
        }
        const box = document.getElementById("reach"), shown = view.reach.children.length;
        box.click();
        const hidden = view.reach.children.length;
        box.click();
        return [shown, outside, hidden];""")
    wanted = 4 if mode == "stoppable" else 0  # a box and its edges, of two bodies
    check(boxes == wanted and hidden == 0, f"{mode}: {boxes} parts of the reach, {hidden} hidden")
    check(outside == 0, f"{mode}: {outside} points outside of the reach")


def check_lines(browser):
    """The picture's own kinematics against the engine's clearance."""
    lines = browser.execute_script("""
        const out = [], rows = axguard.data.samples.rows, draw = axguard.view.draw;
        axguard.view.draw = () => {};  // 200 pictures would keep the browser busy for a minute
        for (let i = 0; i < rows; i += Math.ceil(rows / 200)) {
          axguard.goToRow(i);
          const line = axguard.view.line;
          if (line) out.push([line[0].distanceTo(line[1]), axguard.data.samples.clearance_mm[i]]);
        }
        axguard.view.draw = draw;
        return out;""")
    check(len(lines) > 20, f"only {len(lines)} rows with a nearest pair")
    for drawn, certified in lines:
        check(abs(drawn - certified) < LINE_MM, f"a line of {drawn} mm, clearance {certified} mm")


def check_levels(browser, table):
    """A mark for each stretch below a level, where the table has it."""
    marks = browser.execute_script("""
        return [...document.querySelectorAll("#marks i")].map((mark) =>
          [mark.className, axguard.first + (axguard.last - axguard.first) *
                           parseFloat(mark.style.left) / 100]);""")
    times = [int(row["arrived_us"]) * 1e-6 for row in table]
    stride = browser.execute_script("return axguard.data.samples.stride")
    for level, below in (("warn", ("warn", "slow", "stop")), ("slow", ("slow", "stop"))):
        is_below = [row["level"] in below for row in table]
        begins = [time for i, time in enumerate(times)
                  if is_below[i] and (i == 0 or not is_below[i - 1])]
        drawn = [at for name, at in marks if name == level]
        check(len(begins) > 1, f"{level}: only {len(begins)} stretches to look for")
        slack = 2 * stride * (times[1] - times[0])
        for begin in begins:  # the first is the first sample, of which nothing is known
            check(any(abs(at - begin) < slack for at in drawn),
                  f"{level}: begins at {begin}, marks at {drawn}")


def check_moves(browser):
    shown = "return [axguard.positions, axguard.view.bodies.map((b) => b.matrix.elements)]"
    browser.execute_script("axguard.goToRow(0)")
    before = browser.execute_script(shown)
    browser.execute_script("const s = document.getElementById('slider'); s.value = s.max / 2;"
                           "s.dispatchEvent(new Event('input'))")
    after = browser.execute_script(shown)
    check(before[0] != after[0] and before[1] != after[1], "the slider does not move the machine")

    def press(key):
        ActionChains(browser).send_keys(key).perform()
        return browser.execute_script("return axguard.row")

    browser.execute_script("document.activeElement.blur()")
    rows = browser.execute_script("return axguard.data.samples.rows")
    check(press(Keys.END) == rows - 1, "End does not go to the end")
    check(press(Keys.HOME) == 0, "Home does not go to the start")
    check(press(Keys.ARROW_RIGHT) == 1, "an arrow does not step")
    press("n")
    check(browser.execute_script("return Math.abs(axguard.time - axguard.stops[0].time)") < 1e-6,
          "n does not go to the stop")
    browser.execute_script("axguard.goToRow(0); axguard.speed = 20")
    press(" ")
    started = time_of(browser)
    end = time.monotonic() + 20
    while time_of(browser) <= started + 0.5 and time.monotonic() < end:
        time.sleep(0.1)
    check(time_of(browser) > started + 0.5, "it does not play")
    press(" ")


def check_plots(browser):
    kinds = browser.execute_script("return axguard.plots.plots.map((p) => p.plot.numRows())")
    rows = browser.execute_script("return axguard.data.samples.rows")
    check(len(kinds) >= 4 and all(kind == rows for kind in kinds), f"rows of the plots: {kinds}")
    browser.execute_script("axguard.plots.setRange(axguard.first + 1, axguard.first + 2)")
    ranges = browser.execute_script("return axguard.plots.plots.map((p) => p.plot.xAxisRange())")
    check(len({tuple(one) for one in ranges}) == 1, f"the plots show ranges of their own: {ranges}")


def read_steps(trace):
    """[(time in s, line)] of the table beside a trace."""
    table = trace.with_name(trace.name + ".lines").read_text(encoding="utf-8").split("\n")
    words = [line.split(" ") for line in table[6:] if line and not line.startswith("crc32 ")]
    return [(int(word[0]) * 1e-6, int(word[1])) for word in words]


def current_line(browser, name):
    """The one marked line, None where there is none; it is in view, and the page did not move."""
    marked, scrolled = browser.execute_script("""
        const box = document.getElementById("program_lines").getBoundingClientRect();
        return [[...document.querySelectorAll("#program_rows [aria-current=true]")].map((row) => {
          const own = row.getBoundingClientRect(), style = getComputedStyle(row);
          return [Number(row.querySelector(".number").textContent), row.innerText,
                  own.top >= box.top - 1 && own.bottom <= box.bottom + 1, style.fontWeight];
        }), window.scrollY];""")
    check(len(marked) <= 1, f"{name}: {len(marked)} lines are current")
    check(scrolled == 0, f"{name}: the page was scrolled to {scrolled}")
    for line, text, is_seen, weight in marked:
        check(is_seen, f"{name}: line {line} is current and not in view")
        check(weight == "700", f"{name}: line {line} differs by its colour alone: {text}")
    return marked[0][0] if marked else None


def check_program(browser, results, steps, program):
    """The marked line and the picture's words follow the time; the stop has its mark."""
    browser.execute_script("window.scrollTo(0, 0)")
    blocks = program.read_text(encoding="utf-8").split("\n")
    stop = results["stops"][0]
    check(current_line(browser, "stop") == stop["program_line"], "not the line of the stop")
    marks = browser.execute_script("""
        return [...document.querySelectorAll("#program_rows .mark")].map((mark) =>
          [Number(mark.parentElement.querySelector(".number").textContent), mark.innerText]);""")
    check([stop["program_line"], "stop"] in marks, f"stop at {stop['program_line']}: {marks}")
    first, last = browser.execute_script("return [axguard.first, axguard.last]")
    seen = set()
    for k in range(41):
        at = first + (last - first) * k / 40
        browser.execute_script(f"axguard.goTo({at!r})")
        wanted = [line for begin, line in steps if begin <= at + 5e-7][-1]
        seen.add(wanted)
        check(current_line(browser, f"{at:.3f} s") == (wanted or None),
              f"{at:.3f} s: not line {wanted}")
        here, block = browser.execute_script(
            "return ['here', 'program_text'].map((id) => document.getElementById(id).innerText)")
        is_here = f"{program.name}:{wanted}" in here.split("\n")
        check(is_here == (wanted != 0), f"{at:.3f} s: line {wanted}, the picture says {here}")
        check(block == (blocks[wanted - 1].strip() if wanted else ""), f"line {wanted}: {block}")
    check(len(seen) > 15, f"only {len(seen)} lines to look for")


def check_program_choice(browser, steps):
    """A click or Enter goes to a line's first time; one tab stop; no line after the end."""
    def first_time(line):
        begin = browser.execute_script("return axguard.first")
        return max(begin, next(at for at, one in steps if one == line))

    browser.execute_script("axguard.goTo((axguard.first + axguard.last) / 2)")
    before = current_line(browser, "before the click")
    row = browser.execute_script("""
        return document.querySelector("#program_rows [aria-current]").nextElementSibling""")
    line = int(row.find_element("class name", "number").text)
    ActionChains(browser).move_to_element(row).click().perform()
    check(line > before and abs(time_of(browser) - first_time(line)) < 2e-6,
          f"a click on line {line} goes to {time_of(browser)}, not {first_time(line)}")
    lines = sorted({one for _, one in steps if one})
    there = lines[lines.index(line) - 2]
    browser.execute_script("document.getElementById('program_lines').focus()")
    for _ in range(2):
        ActionChains(browser).send_keys(Keys.ARROW_UP).perform()
    check(abs(time_of(browser) - first_time(line)) < 2e-6, "an arrow alone goes somewhere")
    active = browser.execute_script("""
        const id = document.activeElement.getAttribute("aria-activedescendant");
        return document.getElementById(id).querySelector(".number").textContent;""")
    check(int(active) == there, f"two lines up is {active}, not {there}")
    ActionChains(browser).send_keys(Keys.ENTER).perform()
    check(abs(time_of(browser) - first_time(there)) < 2e-6,
          f"Enter on line {there} goes to {time_of(browser)}, not {first_time(there)}")
    stops, rows = browser.execute_script("""
        const section = document.getElementById("program_section");
        return [[...section.querySelectorAll("*")].filter((e) => e.tabIndex >= 0).map((e) => e.id),
                section.querySelectorAll("[role=option]").length];""")
    check(stops == ["program_lines"], f"tab stops of the program: {stops}")
    firsts = browser.execute_script("""
        const list = Object.create(ProgramList.prototype);  // 7 is a loop's, 9 begins after the end
        list.program = {steps: {time_s: [0, 1, 2, 3, 4], line: [6, 7, 8, 7, 9]}};
        return [[0, 3.5], [1.5, 4], [2, 3]].map((span) => [...list.readFirstTimes(span)]);""")
    check(firsts == [[[6, 0], [7, 1], [8, 2]], [[7, 1.5], [8, 2], [9, 4]], [[8, 2], [7, 3]]],
          f"first times of lines: {firsts}")
    check(0 < rows < 100, f"{rows} rows of {len(lines)} exist at once")
    before = time_of(browser)
    disabled = browser.execute_script("""
        const box = document.getElementById("program_lines");
        box.scrollTop = box.scrollHeight;
        axguard.program.render();
        const row = document.querySelector("#program_rows > :last-child");
        row.click();
        return [Number(row.querySelector(".number").textContent),
                row.getAttribute("aria-disabled")];""")
    check(disabled == [lines[-1], "true"] and time_of(browser) == before,
          f"the last line, after the stop: {disabled}, {time_of(browser)}")


def check_hostile_program(browser, evil):
    """A block is text, with its escapes; its row keeps the order of its parts."""
    found = browser.execute_script("""
        const rows = [...document.querySelectorAll("#program_rows [role=option]")];
        const row = rows.find((one) => one.innerText.includes("script"));
        const left = (e) => e.getBoundingClientRect().left;
        return [document.getElementById("evil") === null, row && row.querySelector("bdi").innerText,
                row && left(row.querySelector(".number")) < left(row.querySelector("bdi")),
                row && getComputedStyle(row.querySelector("bdi")).unicodeBidi];""")
    check(found == [True, evil, True, "isolate"], f"hostile block: {found}")


def check_jogs(browser):
    """Each axis goes forward and back, one after the other, and the bodies with it."""
    shown = "return [axguard.positions, axguard.view.bodies.map((b) => b.matrix.elements)]"
    browser.execute_script("axguard.goTo(0)")
    rest = browser.execute_script(shown)
    units = browser.execute_script("return axguard.data.machine.axes.map((axis) => axis.unit)")
    for i, unit in enumerate(units):
        browser.execute_script(f"axguard.goTo({2 * i + 1})")
        there = browser.execute_script(shown)
        moved = [at - before for at, before in zip(there[0], rest[0])]
        wanted = [0] * i + [50 if unit == "mm" else 15] + [0] * (len(units) - i - 1)
        check(all(abs(a - b) < 1e-3 for a, b in zip(moved, wanted)), f"axis {i}: {moved}")
        check(there[1] != rest[1], f"axis {i} moves no body")
    words = browser.find_element("id", "words").text
    check("0 s to 2 s: +50 mm; X+ moves x to -x" in words, f"check: {words}")


def check_units(browser):
    """Each tick of each chart has its unit."""
    labels = browser.execute_script(
        "return [...document.querySelectorAll('.dygraph-axis-label')].map((e) => e.textContent)")
    bare = [label for label in labels if label and not any(c.isalpha() or c == "%" for c in label)]
    check(len(labels) > 10 and not bare, f"ticks without a unit: {bare} of {labels}")


def check_fingers(browser, name):
    """On a telephone, and on a tablet that is held across."""
    for width, height in SIZES[:2]:
        touch(browser, True)
        resize(browser, width, height)
        small = small_targets(browser)
        check(not small, f"{name} at {width} px: too small for a finger: {small}")
        touch(browser, False)
    resize(browser)


def check_sizes(browser, name):
    """Nothing wider than the screen, no legend over its plot, each control to be reached."""
    for width, height in SIZES:
        resize(browser, width, height)
        wide, outside, covered, small = browser.execute_script("""
            const box = (e) => e.getBoundingClientRect();
            const isShown = (e) => e.offsetParent !== null;
            const all = [...document.querySelectorAll("main *")].filter(isShown);
            const scrolls = (e) => e.closest("#words, #program_rows") !== null;
            const legends = [...document.querySelectorAll(".legend")].filter(isShown);
            return [document.documentElement.scrollWidth - window.innerWidth,
              all.filter((e) => !scrolls(e) && box(e).width > 0 &&
                (box(e).right > window.innerWidth + 1 || box(e).left < -1) &&
                e.closest(".plot") === null).map((e) => e.id || e.tagName),
              legends.filter((e) => [...document.querySelectorAll(".plot canvas")].some((plot) =>
                box(e).bottom > box(plot).top + 1 && box(e).top < box(plot).bottom - 1 &&
                box(e).right > box(plot).left && box(e).left < box(plot).right)).map((e) => e.id),
              [...document.querySelectorAll(".plot canvas, #machine")].filter((e) =>
                isShown(e) && (box(e).width < 250 || box(e).height < 60)).map((e) => e.id)];""")
        at = f"{name} at {width} px"
        check(wide <= 0, f"{at}: {wide} px wider than the screen")
        check(not outside, f"{at}: outside the screen: {outside}")
        check(not covered, f"{at}: a legend covers a plot: {covered}")
        check(not small, f"{at}: too small to be seen: {small}")
        missed = browser.execute_script("""
            return ["play", "next_stop", "contact", "whole", "slider",
                    ...(axguard.program ? ["program_lines"] : [])].filter((id) => {
              const element = document.getElementById(id);
              element.scrollIntoView({block: "center"});
              const box = element.getBoundingClientRect();
              const hit = document.elementFromPoint(box.left + box.width / 2,
                                                    box.top + box.height / 2);
              return !(hit === element || element.contains(hit));
            });""")
        check(not missed, f"{at}: cannot be clicked: {missed}")
    resize(browser)


def luminance(colour):
    parts = [value / 255 for value in colour]
    parts = [v / 12.92 if v <= 0.03928 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def contrast(one, other):
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def hex_colour(text):
    return [int(text[i:i + 2], 16) for i in (1, 3, 5)]


def text_contrasts(browser):
    """Name and contrast of every text that is shown, on its ground."""
    texts = browser.execute_script("""
        const numbers = (text) => text.match(/[\\d.]+/g).map(Number);
        const ground = (e) => {  // what is behind, layers that let some of it through included
          const layers = [];
          for (; e; e = e.parentElement) {
            const [r, g, b, a = 1] = numbers(getComputedStyle(e).backgroundColor);
            if (a > 0) layers.push([r, g, b, a]);
            if (a === 1) break;
          }
          return layers.reverse().reduce((below, [r, g, b, a]) =>
            [r, g, b].map((value, i) => a * value + (1 - a) * below[i]), [255, 255, 255]);
        };
        const hasText = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
        return [...document.querySelectorAll("body *")]
          .filter((e) => hasText(e) && e.offsetParent !== null && !e.disabled)
          .map((e) => [e.id || e.className || e.tagName, numbers(getComputedStyle(e).color),
                       ground(e)]);""")
    return [(name, contrast(colour[:3], behind)) for name, colour, behind in texts]


def check_contrast(browser):
    """Every text on its ground, and every curve, mark and body on its own."""
    texts = text_contrasts(browser)
    check(len(texts) > 40, f"only {len(texts)} texts to look at")
    for name, ratio in texts:
        check(ratio >= TEXT_CONTRAST, f"text of {name}: contrast {ratio:.2f}")
    lines, bodies = browser.execute_script(
        "return [LINE_COLOURS, BODY_COLOURS.map((c) => '#' + c.toString(16).padStart(6, '0'))]")
    for colour in lines:
        ratio = contrast(hex_colour(colour), (255, 255, 255))
        check(ratio >= MARK_CONTRAST, f"curve {colour}: contrast {ratio:.2f} on white")
    for colour in bodies:
        ratio = contrast(hex_colour(colour), hex_colour("#dfe6ec"))
        check(ratio >= MARK_CONTRAST, f"body {colour}: contrast {ratio:.2f} in the view")
    page = hex_colour("#f4f6f8")
    for name, colours in browser.execute_script("""
            return ["stop", "kept_back", "slow", "warn"].map((name) => {
              const style = getComputedStyle(document.querySelector(`#marks_key .${name}`));
              return [name, (style.backgroundImage + style.backgroundColor)
                .match(/rgb\\([^)]*\\)/g).map((text) => text.match(/\\d+/g).map(Number))];
            })"""):
        ratio = max(contrast(colour, page) for colour in colours)
        check(ratio >= MARK_CONTRAST, f"mark {name}: contrast {ratio:.2f}")
    check(contrast((92, 107, 122), (92, 107, 122)) == 1 and
          contrast(hex_colour("#e09f3e"), (255, 255, 255)) < MARK_CONTRAST,
          "the measure finds no fault with a colour that had one")
    styles = browser.execute_script(
        f"return [...Array({PAIRS}).keys()].map((i) => lineStyle(i))"
        ".map(({colour, dash, shape}) => [JSON.stringify([colour, dash]),"
        " JSON.stringify([dash, shape])])")
    check(len({one for one, _ in styles}) == PAIRS, f"{PAIRS} curves share colour and dashes")
    check(len({one for _, one in styles}) == PAIRS, f"{PAIRS} curves are alike without colour")


def check_contact(browser, mode):
    """The button brings the camera to the contact; marks are on the screen; f takes it back."""
    measure = """
        const view = axguard.view, marks = [];
        view.marked.traverse((o) => {
          if (!o.geometry) return;
          const at = o.geometry.attributes.position;
          for (let i = 0; i < at.count; ++i)
            marks.push(new THREE.Vector3().fromBufferAttribute(at, i));
        });
        const seen = marks.filter((mark) => {
          const on = mark.clone().project(view.camera);
          return Math.abs(on.x) <= 1 && Math.abs(on.y) <= 1 && on.z > -1 && on.z < 1;
        });
        return [view.camera.position.distanceTo(view.controls.target), marks.length, seen.length,
                view.bodies.filter((o) => o.material.transparent).length, axguard.time,
                axguard.stops[0].time];"""
    browser.execute_script("axguard.view.frameAll(); axguard.goToRow(0)")
    far = browser.execute_script(measure)[0]
    browser.find_element("id", "contact").click()
    near, marks, seen, through, time_s, stop_s = browser.execute_script(measure)
    check(abs(time_s - stop_s) < 1e-6, f"{mode}: the contact is not at the stop")
    check(near < far / 3, f"{mode}: the camera stays {near} mm away, before {far} mm")
    check(marks > 0 and seen > 0, f"{mode}: {seen} of {marks} marks on the screen")
    check(through >= 1, f"{mode}: no body is seen through")
    red = browser.execute_script("""
        const gl = axguard.view.renderer.getContext(), width = gl.drawingBufferWidth;
        const height = gl.drawingBufferHeight, data = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
        let count = 0;
        for (let i = 0; i < data.length; i += 4)
          count += data[i] > 150 && data[i + 1] < 140 && data[i + 2] < 90;
        return count;""")
    check(red > 20, f"{mode}: {red} pixels of the marked triangles are seen")
    ActionChains(browser).send_keys("f").perform()
    back = browser.execute_script(measure)
    check(back[0] > far / 2 and back[3] == 0, f"{mode}: f does not show the whole machine")
    browser.execute_script("document.activeElement.blur()")
    ActionChains(browser).send_keys("c").perform()
    check(browser.execute_script(measure)[0] < far / 3, f"{mode}: the key c does nothing")


def check_legends(browser):
    """Each curve has its name and value, and its box hides it."""
    found = browser.execute_script("""
        return axguard.plots.plots.map(({id, plot}) => {
          const items = [...document.querySelectorAll(`#${id.replace("plot_", "legend_")} li`)];
          const box = items[0].querySelector("input");
          if (box) box.click();
          const hidden = box && plot.visibility()[0];
          if (box) box.click();
          return [id, items.length, plot.numColumns() - 1, hidden, plot.visibility()[0],
                  items[0].querySelector("output").textContent];
        });""")
    for name, items, curves, hidden, shown, value in found:
        check(items == curves and not hidden and shown, f"{name}: {items} names, {curves} curves")
        check(name == "plot_clearance" or value != "", f"{name}: no value at the shown time")


def main():
    root, axguard = pathlib.Path(sys.argv[1]), sys.argv[2]
    machine = root / "config/machines/paper-trunnion.yaml"
    program = root / "hil_replay/programs/paper-trunnion-demo.ngc"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        trace = folder / "collision.log"
        run([0], axguard, "simulate", machine, program, "-o", trace)
        pages = {}
        for mode in ("stoppable", "contact"):
            page, table = folder / f"{mode}.html", folder / f"{mode}.csv"
            results = run([10], axguard, "replay", machine, trace, "--mode", mode, "--report", page,
                          "--csv", table, "--json")
            with open(table, encoding="utf-8") as lines:
                pages[mode] = (page, json.loads(results), list(csv.DictReader(lines)))
        levels = folder / "levels.yaml"
        levels.write_text(machine.read_text(encoding="utf-8").replace(
            "margin_mm: 0", "margin_mm: 0, slow_mm: 5, warn_mm: 20"), encoding="utf-8")
        run([10], axguard, "replay", levels, trace, "--mesh-root", machine.parent,
            "--report", folder / "levels.html", "--csv", folder / "levels.csv", "--deadline-us",
            "1000000")
        hostile, evil = folder / "hostile.ngc", "</script><b id=evil>x</b>"
        hostile.write_text(f"G21 G90 G94\nT1 M6\nG0 Z50 (\u202e{evil})\nG0 X10\n", encoding="utf-8")
        run([0], axguard, "simulate", machine, hostile, "-o", folder / "hostile.log")
        run([0], axguard, "replay", machine, folder / "hostile.log", "--report",
            folder / "hostile.html")
        driven = folder / "drive.html"
        run([10], axguard, "drive", machine, program, "--report", driven)
        jogs = folder / "check.html"
        run([0], axguard, "check", machine, "--report", jogs)
        browser = browser_or_exit()
        try:
            for mode, (page, results, table) in pages.items():
                look(browser, page)
                check_stop(browser, results, table)
                if mode == "contact":
                    check_touching(browser, results)
                check_why(browser, results, mode)
                check_program(browser, results, read_steps(trace), program)
                check_program_choice(browser, read_steps(trace))
                check_contact(browser, mode)
                check_sizes(browser, mode)
                check_fingers(browser, mode)
                check_units(browser)
            check_contrast(browser)
            check_legends(browser)
            check_plots(browser)
            check_lines(browser)
            check_moves(browser)
            look(browser, folder / "levels.html")
            with open(folder / "levels.csv", encoding="utf-8") as lines:
                check_levels(browser, list(csv.DictReader(lines)))
            look(browser, folder / "hostile.html")
            check_hostile_program(browser, f"G0 Z50 (\\u202e{evil})")
            look(browser, driven)
            check(browser.find_element("id", "headline").text.startswith("STOP"), "drive: no stop")
            check_lines(browser)
            look(browser, jogs)
            check(not browser.find_element("id", "program_section").is_displayed(),
                  "check: a program where there is none")
            check_sizes(browser, "check")
            check_jogs(browser)
        finally:
            browser.quit()
        sizes = {page.name: page.stat().st_size for page in folder.glob("*.html")}
    for fault in faults[:20]:
        print(fault)
    print(f"{len(faults)} faults; bytes of the pages: {sizes}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
