// SPDX-License-Identifier: Apache-2.0
// Puts the page together: data in, one time for the view, the slider and the plots. window.axguard
// is what tests look at.
"use strict";

/** Reasons of a stop (docs/reference/json.md) that have no sentences of their own. */
const PLAIN_REASONS = {
  contact: "two bodies touch, or are nearer than their margin",
  contained: "a body is inside another",
  left_limits: "an axis broke a limit that the machine file declares",
  left_travel: "an axis left its travel",
  left_path: "the axes left the announced path",
  left_jog: "the axes left the chosen jog",
  left_cap: "the board did not obey the speed cap",
  own_stop: "the board stopped by itself",
  tool: "the machine file does not have this tool",
  input: "positions were lost, late or wrong",
  silence: "the last permit has ended",
  engine: "the engine gave no result",
  known_answer: "the engine failed its own test",
};

const PERMIT_GONE = 0.5;
const LEVELS = ["stop", "slow", "warn", "clear"];  // core/guard/margin_state.hpp

class RunPage {
  constructor(data) {
    this.data = data;
    this.row = 0;
    this.speed = 1;
    this.byId = (id) => document.getElementById(id);
    this.writeWords();
    if (data.samples.rows === 0) return;
    this.first = data.samples.time_s[0];
    this.last = data.samples.time_s[data.samples.rows - 1];
    this.stops = this.readStops();
    // A row is shown at its sample of least clearance, which may be one before the stop.
    this.last = Math.max(this.last, ...this.stops.map((stop) => stop.time));
    this.time = this.first;
    this.makeView();
    this.makeControls();
    this.drawMarks();
    const {program} = data;
    this.program = program && Object.keys(program.blocks).length > 0
      ? new ProgramList(program, this.stops, [this.first, this.last], (time) => this.goTo(time))
      : null;
    this.plots = new Plots(data, (time) => this.goTo(time));
    const opensAt = this.stops.find((stop) => !stop.isWithheld) || this.stops[0];
    const asked = /^#t=([-+.\de]+)$/.exec(window.location.hash);
    this.goTo(asked ? Number(asked[1]) : opensAt ? opensAt.time : this.first);
    if (this.view) this.view.frameAll();
  }

  writeWords() {
    const {data} = this;
    document.title = `axguard: ${data.title}`;
    const lines = data.words.split("\n").filter((line) => line.trim() !== "");
    const headline = lines.find((line) => /^(STOP|no stop)/.test(line)) ||
      lines.find((line) => line.startsWith("NO PERMIT")) || lines[0] || "";
    this.byId("headline").textContent = this.inPlainWords(headline);
    this.byId("subline").textContent = `${data.machine.name}: ${data.title}`;
    this.byId("words").textContent = data.words.trim();
    const isStopped = /^(STOP|NO PERMIT)/.test(headline);
    document.querySelector("header").classList.toggle("stopped", isStopped);
    const {count, rows, stride} = data.samples;
    this.byId("rows").textContent = stride > 1
      ? `${count} samples in ${rows} rows of ${stride}: least and most are kept, and the machine is
         shown at the sample of least clearance.` : `${count} samples, all of them.`;
  }

  /** STOP at 3.145 s: why, as a sentence. The command's own line stays where nothing is known. */
  inPlainWords(headline) {
    const [head, seconds] = /^(?:STOP|NO PERMIT).* at ([0-9.]+) s/.exec(headline) || [];
    const stop = head && this.data.stops.find(({time_us: us}) =>
      Math.abs(us * 1e-6 - Number(seconds)) < 1e-6);
    const why = stop && (stop.why && stop.why.sentences ? stop.why.sentences[0]
                                                        : PLAIN_REASONS[stop.reason]);
    return why ? `${head.replace(seconds, Number(seconds).toFixed(3))}: ${why}` : headline;
  }

  /** Time, exact axes and triangles of each stop that the results name. */
  readStops() {
    const {machine} = this.data;
    const pairIndex = new Map(machine.pairs.map((pair, i) => [pair.name, i]));
    return this.data.stops.map((stop) => ({
      time: stop.time_us * 1e-6,
      reason: stop.reason,
      isWithheld: stop.withheld === true,
      why: stop.why || null,
      nearest: (stop.pairs || []).filter((pair) => pair.nearest && stop.why &&
                                                   pair.pair === stop.why.pair)
        .map((pair) => ({pair: pairIndex.get(pair.pair), a: pair.nearest[0],
                         b: pair.nearest[1]}))[0] || null,
      positions: machine.axes.map(({name, unit}) => (stop.axes || {})[`${name}_${unit}`]),
      touching: (stop.pairs || []).map((pair) => ({
        pair: pairIndex.get(pair.pair), triangles: pair.triangles || []})),
    })).filter((stop) => stop.time >= this.first - 1 && stop.time <= this.last + 1)
      .sort((a, b) => a.time - b.time);
  }

  makeView() {
    try {
      this.view = new MachineView(this.byId("machine"), this.data);
    } catch (error) {
      this.byId("no_webgl").hidden = false;
      this.view = null;
      return;
    }
    this.view.addBodyBoxes(this.byId("bodies"), () => this.goTo(this.time));
    window.addEventListener("resize", () => this.view.draw());
  }

  makeControls() {
    const slider = this.byId("slider");
    slider.max = this.data.samples.rows - 1;
    slider.addEventListener("input", () => this.goToRow(Number(slider.value)));
    this.byId("play").addEventListener("click", () => this.togglePlay());
    this.byId("speed").addEventListener("change", (event) => {
      this.speed = Number(event.target.value);
    });
    this.byId("next_stop").addEventListener("click", () => this.goToStop(1));
    this.byId("previous_stop").addEventListener("click", () => this.goToStop(-1));
    this.byId("contact").addEventListener("click", () => this.goToContact());
    this.byId("whole").addEventListener("click", () => this.view && this.view.frameAll());
    this.byId("contact").disabled = this.byId("whole").disabled = this.view === null;
    this.byId("reach").addEventListener("change", () => this.goTo(this.time));
    document.addEventListener("keydown", (event) => this.onKey(event));
  }

  onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
    const isPressed = ["BUTTON", "INPUT"].includes(event.target.tagName) &&
      event.target.type !== "range";
    if (event.key === " " && isPressed) return;  // what has the focus is pressed
    const step = event.shiftKey ? 100 : 1;
    const actions = {
      " ": () => this.togglePlay(),
      ArrowRight: () => this.goToRow(this.row + step),
      ArrowLeft: () => this.goToRow(this.row - step),
      Home: () => this.goToRow(0),
      End: () => this.goToRow(this.data.samples.rows - 1),
      n: () => this.goToStop(1),
      p: () => this.goToStop(-1),
      c: () => this.goToContact(),
      f: () => this.view && this.view.frameAll(),
    };
    if (actions[event.key]) {
      actions[event.key]();
      event.preventDefault();
    }
  }

  drawMarks() {
    const {samples} = this.data, span = Math.max(1e-9, this.last - this.first);
    const add = (from, to, className, title) => {
      const mark = document.createElement("i");
      mark.className = className;
      mark.title = title;
      mark.style.left = `${100 * (from - this.first) / span}%`;
      mark.style.width = `${100 * (to - from) / span}%`;
      this.byId("marks").append(mark);
    };
    const addWhere = (values, holds, className, title) => {
      let since = null;
      values.forEach((value, i) => {
        if (holds(value) && since === null) since = samples.time_s[i];
        if (since !== null && (!holds(value) || i === samples.rows - 1)) {
          add(since, samples.time_s[i], className, title);
          since = null;
        }
      });
    };
    addWhere(samples.level, (level) => level <= LEVELS.indexOf("warn"), "warn", "level: warn");
    addWhere(samples.level, (level) => level <= LEVELS.indexOf("slow"), "slow", "level: slow");
    addWhere(samples.permit, (permit) => permit < PERMIT_GONE, "kept_back", "no permit");
    for (const stop of this.stops) {
      if (!stop.isWithheld) add(stop.time, stop.time, "stop", `stop: ${stop.reason}`);
    }
  }

  /** The last row that is not after a time. */
  rowAt(time) {
    return Math.max(0, lastNotAfter(this.data.samples.time_s, time));
  }

  goToRow(row) {
    const kept = Math.min(this.data.samples.rows - 1, Math.max(0, row));
    this.goTo(this.data.samples.time_s[kept]);
  }

  goToStop(direction) {
    const ahead = this.stops.filter((stop) => direction * (stop.time - this.time) > 1e-6);
    if (ahead.length === 0) return;
    this.goTo(direction > 0 ? ahead[0].time : ahead[ahead.length - 1].time);
  }

  /** At the shown stop, else the nearest in time, else the row of least clearance. */
  goToContact() {
    if (!this.view) return;
    const away = (stop) => Math.abs(stop.time - this.time);
    if (this.stops.length > 0) {
      this.goTo(this.stops.reduce((a, b) => (away(b) < away(a) ? b : a)).time);
    } else {
      const least = this.data.samples.clearance_mm;
      const row = least.reduce((best, value, i) =>
        (value !== null && (best < 0 || value < least[best]) ? i : best), -1);
      if (row >= 0) this.goToRow(row);
    }
    this.view.frameContact();
  }

  goTo(time) {
    const {samples, machine} = this.data;
    this.time = Math.min(this.last, Math.max(this.first, time));
    this.row = this.rowAt(this.time);
    // A stop is shown exactly, whatever row it fell into.
    const stop = this.stops.find((one) => Math.abs(one.time - this.time) < 1e-6) || null;
    const isExact = stop !== null && stop.positions.every((value) => value !== undefined);
    const positions = isExact ? stop.positions
      : machine.axes.map(({name, unit}) => samples[`${name}_${unit}`][this.row]);
    const pair = samples.pair[this.row];
    const ofRow = pair === null ? null
      : {pair, a: samples.triangle_a[this.row], b: samples.triangle_b[this.row]};
    const nearest = stop && stop.nearest ? stop.nearest : ofRow;
    this.positions = positions;
    if (this.view) {
      this.view.setReach(stop && stop.why && this.byId("reach").checked
        ? stop.why.reach_bodies || [] : []);
      this.view.show(positions, samples.tool[this.row], nearest, stop ? stop.touching : []);
    }
    writeWhy(stop && stop.why);
    this.byId("slider").value = this.row;
    this.byId("clock").textContent = `${this.time.toFixed(3)} s`;
    if (this.program) this.program.setTime(this.time);
    this.writeHere(positions, stop);
    if (this.plots) this.plots.setTime(this.time, this.row);
  }

  writeHere(positions, stop) {
    const {samples, machine} = this.data;
    const lines = machine.axes.map(({name, unit}, i) =>
      `${name} ${positions[i].toFixed(unit === "mm" ? 3 : 4)} ${unit}`);
    const pair = samples.pair[this.row], least = samples.clearance_mm[this.row];
    if (pair !== null) lines.push(`${machine.pairs[pair].name}: ${least.toFixed(3)} mm`);
    const hasPermit = !stop && samples.permit[this.row] >= PERMIT_GONE;
    const valid = samples.valid_periods[this.row], cap = samples.cap_percent[this.row];
    lines.push(!hasPermit ? "no permit" : !valid ? "permit" : `permit for ${valid} periods`);
    if (hasPermit && cap !== null && cap < 100) lines.push(`cap: ${cap.toFixed(1)} % of rapid`);
    const level = LEVELS[samples.level[this.row]];
    if (level !== "clear") lines.push(`level: ${level}`);
    if (stop) lines.push(`${stop.isWithheld ? "NO PERMIT" : "STOP"}: ${stop.reason}`);
    const here = this.byId("here");
    here.textContent = lines.join("\n");
    if (this.program && this.program.line !== 0) {
      const file = document.createElement("bdi");  // a name in its own direction of writing
      file.textContent = this.program.name;
      here.append("\n", file, `:${this.program.line}`);
    }
  }

  togglePlay() {
    this.isPlaying = !this.isPlaying;
    this.byId("play").textContent = this.isPlaying ? "Pause" : "Play";
    if (!this.isPlaying) return;
    if (this.time >= this.last) this.goTo(this.first);
    let before = performance.now();
    const step = (now) => {
      if (!this.isPlaying) return;
      this.goTo(this.time + (now - before) * 1e-3 * this.speed);
      before = now;
      if (this.time >= this.last) {
        this.togglePlay();
      } else {
        requestAnimationFrame(step);
      }
    };
    requestAnimationFrame(step);
  }
}

window.axguard = new RunPage(JSON.parse(document.getElementById("data").textContent));
