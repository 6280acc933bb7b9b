// SPDX-License-Identifier: Apache-2.0
// The live page: states of the guard come as events and are shown, nothing goes back. window.axguard
// is what tests look at.
"use strict";

/** What each state means for the person at the machine. */
const PLAIN_STATES = {
  armed: "The machine may move while each stop is proven.",
  ready: "No motion is permitted. Arm the board, then the guard.",
  selftest: "No motion is permitted: the guard tests itself, or cannot prove a stop from here.",
  init: "No motion is permitted: the guard starts.",
  running: "The guard runs; whether it is armed is not known here.",
  stopped: "No motion is permitted. Remove the cause, reset, arm.",
  unreachable: "Nothing is known of the guard.",
};
const STATE_MARKS = {armed: "\u25cf", ready: "\u25c6", selftest: "\u25cb", init: "\u25cb",
                     running: "\u25d0", stopped: "\u25a0", unreachable: "\u2715"};
const SILENT_MS = 2000;    // without an event: the server does not answer
const OLD_MS = 500;        // older values are shown as old
const REOPEN_MS = 3000;    // after an answer that ends a stream for good
const PAIR_GLOW = 0x5a2c00;

function seconds(ms) {
  return ms < 10000 ? `${(ms / 1000).toFixed(1)} s` : `${Math.round(ms / 1000)} s`;
}

class LivePage {
  constructor(data) {
    this.data = data;
    this.byId = (id) => document.getElementById(id);
    this.events = 0;
    this.state = null;
    this.heardAt = performance.now();
    this.isDrawn = true;
    this.makeView();
    document.addEventListener("keydown", (event) => {
      if (event.key === "f" && !event.ctrlKey && !event.altKey && !event.metaKey) this.showWhole();
    });
    this.byId("whole").addEventListener("click", () => this.showWhole());
    this.listen();
    setInterval(() => this.lookForSilence(), 500);
  }

  makeView() {
    try {
      this.view = new MachineView(this.byId("machine"), this.data);
    } catch (error) {
      this.view = null;
      this.byId("canvas_box").hidden = this.byId("controls").hidden = true;
      return;
    }
    this.view.addBodyBoxes(this.byId("bodies"), () => {
      this.placed = null;
      this.place(this.pair);
    });
    this.positions = this.data.machine.axes.map(() => 0);
    this.tool = 0;
    this.place();
    this.view.frameAll();
    window.addEventListener("resize", () => this.view.draw());
  }

  showWhole() {
    if (this.view) this.view.frameAll();
  }

  listen() {
    this.source = new EventSource("events");
    this.source.onmessage = (event) => this.take(JSON.parse(event.data));
    this.source.onerror = () => {
      if (this.source.readyState === EventSource.CLOSED) {
        setTimeout(() => this.listen(), REOPEN_MS);
      }
    };
  }

  lookForSilence() {
    const silent = performance.now() - this.heardAt;
    if (silent < SILENT_MS) return;
    this.writeHeadline("unreachable", "axguard watch does not answer", silent);
    this.byId("facts").classList.add("old");
  }

  take(state) {
    if (this.state && state.configuration !== this.state.configuration) {
      window.location.reload();  // another machine file
      return;
    }
    this.state = state;
    this.heardAt = performance.now();
    this.events += 1;
    if (!this.isDrawn) return;
    this.isDrawn = false;  // events that come before the next frame are shown with it
    requestAnimationFrame(() => {
      this.isDrawn = true;
      this.show(this.state);
    });
  }

  show(state) {
    this.byId("facts").classList.remove("old");
    this.writeHeadline(state.kind, state.headline, state.since_ms);
    this.writeNotes(state.notes);
    this.writePermit(state);
    this.writeStateWhy(state);
    this.writeClearance(state);
    this.writeAxes(state);
    this.writeGuard(state);
    if (state.axes) {
      this.positions = state.axes.positions;
      this.tool = state.axes.tool;
    }
    this.byId("view_words").textContent = state.axes ? "" :
      "Positions are not known: all axes are drawn at 0.";
    this.pair = state.hints ? state.hints.pair : null;
    this.place(this.pair);
  }

  writeHeadline(kind, text, since) {
    const isNew = this.byId("headline").textContent !== text;
    this.byId("header").className = kind;
    this.byId("mark").textContent = STATE_MARKS[kind] || "";
    this.byId("plain").textContent = PLAIN_STATES[kind] || "";
    const source = this.state && this.state.bus ? ` on ${this.state.bus.name}` : "";
    this.byId("subline").textContent = `${this.data.machine.name}${source}` +
      (since === null ? "" : `, for ${seconds(since)}`);
    if (!isNew) return;
    this.byId("headline").textContent = text;
    document.title = `${text} - axguard`;
    // A screen reader says a stop at once, and everything else when it has time.
    const isAlarm = kind === "stopped" || kind === "unreachable";
    this.byId("alarm").textContent = isAlarm ? text : "";
    this.byId("news").textContent = isAlarm ? "" : text;
  }

  writeNotes(notes) {
    const list = this.byId("notes"), words = notes.join("\n");
    if (words === this.notes) return;  // a screen reader says what is new, and nothing again
    this.notes = words;
    list.replaceChildren(...notes.map((note) => {
      const item = document.createElement("li");
      item.textContent = note;
      return item;
    }));
  }

  /** @param rows  [[name, value, class]] */
  writeList(id, rows) {
    const list = this.byId(id);
    while (list.children.length > 2 * rows.length) list.lastChild.remove();
    while (list.children.length < 2 * rows.length) {
      list.append(document.createElement(list.children.length % 2 === 0 ? "dt" : "dd"));
    }
    rows.forEach(([name, value, className], i) => {
      const dt = list.children[2 * i], dd = list.children[2 * i + 1];
      if (dt.textContent !== name) dt.textContent = name;
      if (dd.textContent !== value) dd.textContent = value;
      dd.className = className || "";
    });
  }

  writePermit({permit, guard}) {
    const rows = [];
    if (!permit) {
      rows.push(["permit", "none seen", "strong"]);
    } else {
      const isGiven = permit.in_force;
      rows.push(["permit", isGiven ? permit.word : "none in force", "strong"]);
      if (isGiven) {
        rows.push(["valid", `${permit.samples} samples, ${permit.valid_ms.toFixed(1)} ms`]);
        rows.push(["cap", permit.cap_percent >= 100 ? "none (100 % of rapid)"
          : `${permit.cap_percent.toFixed(1)} % of rapid`]);
        if (permit.level) rows.push(["level", permit.level]);
      }
      if (permit.answer === "wrong") rows.push(["answer", "wrong for the board's session", "old"]);
    }
    if (guard && guard.withheld) rows.push(["withheld", guard.withheld]);
    this.writeList("permit", rows);
  }

  /** Needed and available distance of each stop and each permit withheld, and the parts. */
  writeStateWhy({why: whys}) {
    const mm = (value) => `${value.toFixed(4)} mm`;
    const rows = whys.flatMap(({of, pair, distances: why, words, ways_out: ways}) => {
      const tool = why && why.tool !== null ? `, tool ${why.tool}` : "";
      const head = pair === null ? [] : [[of, `${pair}${tool}`, "strong"]];
      const leads = ways.map((way) => ["way out", way, "strong"]);
      if (!why) {
        const none = words ? [[pair === null ? of : "distances", words, "old"]] : [];
        return [...head, ...none, ...leads];
      }
      const isFar = why.available_mm >= why.within_mm;
      const open = why.open ? [["first part left open",
        `needs ${mm(why.open.needed_mm)} and has ${mm(why.open.available_mm)}`]] : [];
      return [...head, ...leads, ["needed", mm(why.needed_mm), "strong"],
        ["available", why.available_mm <= 0 ? "none"
          : `${isFar ? "at least " : ""}${mm(why.available_mm)}`, "strong"],
        ...WHY_PARTS.filter(([key]) => why[key] !== null).map(([key, label]) =>
          [key === "margin_mm" && why.jog ? "clearance to keep in this jog" : label, mm(why[key])]),
        ...open, ...(why.list_full ? [["engine", "a list was full"]] : [])];
    });
    this.byId("why_section").hidden = rows.length === 0;
    this.writeList("why", rows);
  }

  writeClearance({hints}) {
    if (!hints) {
      this.writeList("clearance", [["nearest pair", "not known"]]);
      return;
    }
    const isOld = hints.age_ms > OLD_MS;
    const distance = hints.pair === null && hints.distance_mm === 0 ? "not known"
      : hints.distance_mm === 0 ? "not proven"
      : `${hints.is_more ? "more than" : "at least"} ${hints.distance_mm.toFixed(2)} mm`;
    this.writeList("clearance", [
      ["nearest pair", hints.name === null ? "none" : hints.name, isOld ? "old" : ""],
      ["clearance", isOld ? `${distance} (${seconds(hints.age_ms)} ago)` : distance,
       isOld ? "old" : "strong"]]);
  }

  writeAxes({axes}) {
    if (!axes) {
      this.writeList("axes", [["positions", "not known"]]);
      return;
    }
    const isOld = axes.age_ms > OLD_MS;
    const rows = this.data.machine.axes.map(({name, unit}, i) =>
      [name, `${axes.positions[i].toFixed(unit === "mm" ? 3 : 4)} ${unit}`, isOld ? "old" : ""]);
    const isGuarded = axes.tool === axes.guarded_tool;  // else tool 0 is guarded as first_tool
    rows.push(["tool", isGuarded ? String(axes.tool)
      : `${axes.tool} (guarded as first_tool, ${axes.guarded_tool})`], ["mode", axes.mode]);
    if (isOld) rows.push(["sample", `${seconds(axes.age_ms)} old`, "old"]);
    this.writeList("axes", rows);
  }

  writeGuard({guard, bus, reads_status: readsStatus}) {
    const rows = [];
    if (bus) {
      const silent = bus.guard_age_ms;
      rows.push(["heard on the bus", silent === null ? "never" : silent < 250 ? "now"
        : `${seconds(silent)} ago`, silent !== null && silent < 250 ? "" : "old"]);
    }
    if (guard) {
      rows.push(["machine file", guard.same_machine ? "the guard's" : "differs from the guard's",
                 guard.same_machine ? "" : "old"]);
      rows.push(["mode", guard.mode]);
      if (guard.stands !== null) rows.push(["axes", guard.stands ? "at rest" : "not at rest"]);
      if (guard.phase === "stopped") {
        rows.push(["stop", guard.confirmed ? "confirmed" : "not confirmed"]);
      }
      rows.push(["samples, permits", `${guard.samples}, ${guard.permits}`]);
      rows.push(["late, lost", `${guard.late}, ${guard.lost}`]);
      rows.push(["axguardd", guard.version]);
    } else {
      rows.push(["status socket", readsStatus ? "not reachable" : "not read"]);
    }
    this.writeList("guard", rows);
  }

  /** Draws the machine where it is; where nothing has moved there is nothing to draw. */
  place(pair = null) {
    if (!this.view) return;
    const key = JSON.stringify([this.positions, this.tool, pair]);
    const isSame = key === this.placed;
    this.placed = key;
    if (isSame) return;
    const glowing = pair === null ? [] :
      [this.data.machine.pairs[pair].a, this.data.machine.pairs[pair].b];
    this.view.bodies.forEach((object, i) =>
      object.material.emissive.setHex(glowing.includes(i) ? PAIR_GLOW : 0));
    const tool = this.data.machine.bodies.findIndex((body) => body.is_tool);
    for (const object of this.view.tools) {
      object.material.emissive.setHex(glowing.includes(tool) ? PAIR_GLOW : 0);
    }
    this.view.show(this.positions, this.tool, null, []);
  }
}

fetch("machine.json").then((reply) => reply.json()).then((data) => {
  window.axguard = new LivePage(data);
}).catch((error) => {
  document.getElementById("headline").textContent = "The page could not be loaded";
  document.getElementById("subline").textContent = String(error);
});
