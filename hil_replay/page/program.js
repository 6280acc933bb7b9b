// SPDX-License-Identifier: Apache-2.0
// The program's lines as one list, of which only the rows in view exist: the line of the shown time
// is marked and in view, a chosen one is where the page goes.
"use strict";

const PROGRAM_ROW_PX = window.matchMedia("(pointer: coarse)").matches ? 44 : 20;  // page.css
const PROGRAM_ROWS_MORE = 20;  // above and below what is in view
const PROGRAM_NAME_MAX = 32;   // characters of the file's name over the picture

/** The last of increasing times that is not after `time`, by its index; -1: all are after it. */
function lastNotAfter(times, time) {
  let low = -1, high = times.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (times[middle] <= time + 5e-7) low = middle;
    else high = middle - 1;
  }
  return low;
}

class ProgramList {
  /**
   * @param program  as page_program_json.hpp writes it
   * @param stops  [{time, isWithheld}]
   * @param span  [first, last] time of the page
   * @param goTo  called with the first time of a chosen line
   */
  constructor(program, stops, span, goTo) {
    this.program = program;
    this.goTo = goTo;
    const name = program.file.split("/").pop();
    this.name = name.length > PROGRAM_NAME_MAX ? `\u2026${name.slice(-PROGRAM_NAME_MAX)}` : name;
    this.lines = Object.keys(program.blocks).map(Number).sort((a, b) => a - b);
    this.rowOf = new Map(this.lines.map((line, i) => [line, i]));
    this.firstTimes = this.readFirstTimes(span);
    this.marks = this.readMarks(stops);
    this.shown = new Map();  // elements by row
    this.current = this.cursor = -1;
    this.makeBox();
  }

  /** Of each line that the page has a time of: a replay may end long before its trace. */
  readFirstTimes([first, last]) {
    const {time_s: times, line: lines} = this.program.steps, out = new Map();
    lines.forEach((line, i) => {
      const from = Math.max(first, times[i]), isOver = i + 1 < times.length && times[i + 1] <= from;
      if (!isOver && from <= last && !out.has(line)) out.set(line, from);
    });
    return out;
  }

  /** Class and text of the mark of each line that has one. */
  readMarks(stops) {
    const marks = new Map();
    for (const {time, isWithheld} of stops) {
      const line = this.lineAt(time);
      if (!isWithheld) marks.set(line, ["stop", "stop"]);
      else if (!marks.has(line)) marks.set(line, ["", "no permit"]);
    }
    return marks;
  }

  makeBox() {
    const byId = (id) => document.getElementById(id), {steps, count, file} = this.program;
    [this.box, this.list] = [byId("program_lines"), byId("program_rows")];
    byId("program_section").hidden = false;
    byId("program_file").textContent = file;
    byId("program_read_as").textContent = this.program.read_as;
    const kept = steps.line.length;
    byId("program_count").textContent = kept === count ? ""
      : `The program is long: lines that no row of this page is drawn in are left out (${kept} of
         ${count} steps are kept).`.replace(/\s+/g, " ");
    this.list.style.height = `${PROGRAM_ROW_PX * this.lines.length}px`;
    this.box.addEventListener("scroll", () => this.render());
    window.addEventListener("resize", () => this.render());
    this.box.addEventListener("keydown", (event) => this.onKey(event));
    this.list.addEventListener("click", (event) => {
      const row = event.target.closest("[role=option]");
      if (row) this.choose(Number(row.dataset.row));
    });
  }

  onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const page = Math.max(1, Math.floor(this.box.clientHeight / PROGRAM_ROW_PX) - 1);
    const steps = {ArrowUp: -1, ArrowDown: 1, PageUp: -page, PageDown: page};
    if (event.key === "Enter") this.choose(this.cursor);
    else if (event.key in steps) this.moveCursor(this.cursor + steps[event.key]);
    else return;
    event.preventDefault();
  }

  choose(row) {
    const time = this.firstTimes.get(this.lines[row]);
    if (time !== undefined) this.goTo(time);
  }

  moveCursor(row) {
    this.cursor = Math.min(this.lines.length - 1, Math.max(0, row));
    this.reveal(this.cursor);
  }

  /** The line at a time; 0: before the first move. */
  lineAt(time) {
    const {steps} = this.program, step = lastNotAfter(steps.time_s, time);
    return step < 0 ? 0 : steps.line[step];
  }

  setTime(time) {
    const line = this.lineAt(time), row = line === 0 ? -1 : this.rowOf.get(line);
    this.line = line;
    if (row === this.current && this.shown.size > 0) return;
    this.current = row;
    this.cursor = row;
    const put = (id, text) => { document.getElementById(id).textContent = text; };
    put("program_at", line === 0 ? "before the first move" : `line ${line}:`);
    put("program_text", line === 0 ? "" : this.program.blocks[line]);
    this.reveal(Math.max(0, row));
  }

  /** Scrolls the list, never the page. */
  reveal(row) {
    const top = PROGRAM_ROW_PX * row, height = this.box.clientHeight;
    if (top < this.box.scrollTop + PROGRAM_ROW_PX ||
        top + 2 * PROGRAM_ROW_PX > this.box.scrollTop + height) {
      this.box.scrollTop = top - height / 2;
    }
    this.render();
  }

  render() {
    const inView = Math.ceil(this.box.clientHeight / PROGRAM_ROW_PX);
    const first = Math.max(0, Math.floor(this.box.scrollTop / PROGRAM_ROW_PX) - PROGRAM_ROWS_MORE);
    const end = Math.min(this.lines.length, first + inView + 2 * PROGRAM_ROWS_MORE);
    for (const [i, row] of this.shown) {
      if (i >= first && i < end) continue;
      row.remove();
      this.shown.delete(i);
    }
    for (let i = end - 1; i >= first; --i) {  // each before the next one: read in their order
      if (this.shown.has(i)) continue;
      const row = this.makeRow(i);
      this.list.insertBefore(row, this.shown.get(i + 1) || null);
      this.shown.set(i, row);
    }
    this.mark();
  }

  makeRow(i) {
    const line = this.lines[i], row = document.createElement("div");
    row.id = `program_row_${i}`;
    row.dataset.row = i;
    row.style.top = `${PROGRAM_ROW_PX * i}px`;
    const attributes = {role: "option", "aria-posinset": i + 1, "aria-setsize": this.lines.length};
    Object.entries(attributes).forEach(([name, value]) => row.setAttribute(name, value));
    if (!this.firstTimes.has(line)) row.setAttribute("aria-disabled", "true");
    const add = (tag, className, text) => {
      const part = document.createElement(tag);
      part.className = className;
      part.textContent = text;
      row.append(part, " ");
    };
    add("span", "number", line);
    if (this.marks.has(line)) {
      const [name, text] = this.marks.get(line);
      add("span", `mark ${name}`, text);
    }
    add("bdi", "", this.program.blocks[line]);
    return row;
  }

  mark() {
    for (const [i, row] of this.shown) {
      row.setAttribute("aria-selected", i === this.current);
      if (i === this.current) row.setAttribute("aria-current", "true");
      else row.removeAttribute("aria-current");
      row.classList.toggle("cursor", i === this.cursor);
    }
    if (this.shown.has(this.cursor)) {
      this.box.setAttribute("aria-activedescendant", this.shown.get(this.cursor).id);
    } else {
      this.box.removeAttribute("aria-activedescendant");
    }
  }
}
