// SPDX-License-Identifier: Apache-2.0
// The plots over time, linked: one range of time, one hair line, a click goes there. dygraphs draws.
"use strict";

// Eight colours, three dashes and eight marks: curve i is like no other of the first 24, with or
// without colour. Each colour has a contrast of 4.5:1 or more on white.
const LINE_COLOURS = ["#1d6fa5", "#a4161a", "#2f7a3d", "#7b4fa3", "#8a5a00", "#4d5a67", "#b4145a",
                      "#00707a"];
const LINE_DASHES = [[], [7, 3], [2, 3]];
const MARKS_A_CURVE = 6;
/** Tick labels of an axis with their unit. */
const withUnit = (unit) => (value) => `${Number(value.toPrecision(4))} ${unit}`;
const asPercent = (value) => `${Math.round(100 * value)} %`;
const asYesOrNo = (value) => ({0: "no", 1: "yes"}[value] || "");
/** Corners of each mark, in a square from -1 to 1; a mark without area is drawn with lines. */
const MARK_SHAPES = [
  [[-1, -1], [1, -1], [1, 1], [-1, 1]], [[0, -1.2], [1.1, 1], [-1.1, 1]],
  [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]], [[-1, -1], [1, 1], [0, 0], [-1, 1], [1, -1], [0, 0]],
  [[0, 1.2], [1.1, -1], [-1.1, -1]], [[-1.3, 0], [1.3, 0], [0, 0], [0, -1.3], [0, 1.3], [0, 0]],
  [[1.2, 0], [-1, 1.1], [-1, -1.1]], [[-1.4, -0.6], [1.4, -0.6], [1.4, 0.6], [-1.4, 0.6]]];

/** {colour, dash, shape} of curve i. */
function lineStyle(i) {
  const group = Math.floor(i / LINE_COLOURS.length) % LINE_DASHES.length;
  return {colour: LINE_COLOURS[i % LINE_COLOURS.length], dash: LINE_DASHES[group],
          shape: MARK_SHAPES[(i + group) % MARK_SHAPES.length]};
}

function drawMark(context, shape, x, y, colour) {
  context.fillStyle = context.strokeStyle = colour;
  context.beginPath();
  shape.forEach(([dx, dy], i) => {
    if (i === 0) context.moveTo(x + 3.5 * dx, y + 3.5 * dy);
    else context.lineTo(x + 3.5 * dx, y + 3.5 * dy);
  });
  context.closePath();
  context.fill();
  context.stroke();
}

/** What stands before a name in a legend: the line, its dashes and its mark. */
function lineSample({colour, dash, shape}) {
  const corners = shape.map(([x, y]) => `${17 + 3.5 * x},${6 + 3.5 * y}`).join(" ");
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 34 12");
  svg.setAttribute("aria-hidden", "true");
  svg.innerHTML = `<path d="M0 6H34" stroke="${colour}" stroke-width="2"
      stroke-dasharray="${dash.join(" ")}"/>
    <polygon points="${corners}" fill="${colour}" stroke="${colour}"/>`;
  return svg;
}

class Plots {
  /** @param goTo  called with a time in s */
  constructor(data, goTo) {
    this.data = data;
    this.goTo = goTo;
    this.plots = [];
    this.addClearance();
    this.addAxes();
    this.addSpeeds();
    this.addPermit();
    const {cycle_us: cycles, valid_periods: valid, cap_percent: cap} = data.samples;
    this.addOrHide(cycles, "cycles", () => this.addCycles(cycles));
    this.addOrHide(cycles, "histogram", () => this.addHistogram());
    this.addOrHide(valid, "valid", () => this.addSteps("plot_valid", "periods", valid, 15.5,
                                                           withUnit("periods")));
    this.addOrHide(cap, "cap", () => this.addSteps("plot_cap", "% of rapid", cap, 105,
                                                     withUnit("%")));
    window.addEventListener("resize", () => this.setTime(this.time));
  }

  addClearance() {
    const {machine, samples, within_mm: within} = this.data;
    const near = machine.pairs.map((pair, i) => ({...pair, values: samples[`pair_${i}_mm`]}))
      .filter((pair) => pair.values.some((value) => value !== null));
    if (near.length === 0) {
      document.getElementById("plot_clearance").textContent =
        `No checked pair came within ${within} mm.`;
      return;
    }
    const margins = [...new Set(near.map((pair) => pair.margin_mm))];
    this.add("plot_clearance", near.map((pair) => pair.name), (i) => near.map((p) => p.values[i]),
             {valueRange: [0, within], levels: margins, label: withUnit("mm")});
  }

  /** Least, shown and most of each axis, as shares of its range in this run. */
  addAxes() {
    const {machine, samples} = this.data, names = [], scales = [];
    machine.axes.forEach(({name, unit}) => {
      const number = (value) => value !== null;
      const low = samples[`${name}_least_${unit}`].filter(number).reduce((a, b) => Math.min(a, b));
      const high = samples[`${name}_most_${unit}`].filter(number).reduce((a, b) => Math.max(a, b));
      names.push(`${name} ${low.toFixed(1)}..${high.toFixed(1)} ${unit}`);
      scales.push((value) => (high > low ? (value - low) / (high - low) : 0.5));
    });
    this.addBands("plot_axes", names, (i) => machine.axes.map(({name, unit}, k) =>
      [`${name}_least_${unit}`, `${name}_${unit}`, `${name}_most_${unit}`]
        .map((column) => scales[k](samples[column][i]))), [-0.03, 1.03]);
  }

  addSpeeds() {
    const {machine, samples} = this.data;
    const share = (value, fastest) => (value === null ? null : value / fastest);
    this.addBands("plot_speeds", machine.axes.map((axis) => axis.name), (i) =>
      machine.axes.map(({name, unit, speed_max: fastest}) => {
        const least = share(samples[`${name}_least_${unit}_s`][i], fastest);
        const most = share(samples[`${name}_most_${unit}_s`][i], fastest);
        return least === null ? [null, null, null] : [least, 0.5 * (least + most), most];
      }), null);
  }

  addPermit() {
    this.addSteps("plot_permit", "permit", this.data.samples.permit, 1.15, asYesOrNo);
  }

  addSteps(id, name, values, most, label) {
    this.add(id, [name], (i) => [values[i]],
             {stepPlot: true, fillGraph: true, valueRange: [0, most], label});
  }

  /** A plot of a column that has no value in this run is left out. */
  addOrHide(column, name, add) {
    if (column.some((value) => value !== null)) {
      add();
      return;
    }
    for (const part of ["title", "legend", "plot"]) {
      const element = document.getElementById(`${part}_${name}`);
      if (element) element.hidden = true;
    }
  }

  addCycles(spent) {
    this.add("plot_cycles", ["slowest"], (i) => [spent[i]],
             {levels: [this.data.deadline_us], logscale: true, label: withUnit("us")});
  }

  addHistogram() {
    const rows = this.data.cycle_times_us;
    const element = document.getElementById("plot_histogram");
    this.histogram = new Dygraph(element, rows, {
      labels: ["us", "cycles"], logscale: true, stepPlot: true, fillGraph: true,
      axes: {x: {logscale: true, axisLabelFormatter: withUnit("us")},
             y: {axisLabelWidth: 84, axisLabelFormatter: withUnit("cycles")}}, colors: ["#1d6fa5"],
      legend: "never", dateWindow: [0.9 * rows[0][0],
                                    1.2 * Math.max(rows[rows.length - 1][0], this.data.deadline_us)],
      underlayCallback: (context, area, plot) => {
        const x = plot.toDomXCoord(this.data.deadline_us);
        this.dash(context, x, area.y, x, area.y + area.h);
      }});
  }

  addBands(id, names, values, valueRange) {
    this.add(id, names, values, {customBars: true, label: asPercent, ...(valueRange ? {valueRange} : {})});
  }

  dash(context, x0, y0, x1, y1) {
    context.save();
    context.setLineDash([6, 4]);
    context.strokeStyle = "#a4161a";
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
    context.restore();
  }

  /** Marks on a curve: a few over the width that is seen, not at the same places as the others'. */
  drawMarks(plotted) {
    const {points, drawingContext: context, seriesIndex, seriesCount, plotArea: area} = plotted;
    const {colour, shape} = lineStyle(seriesIndex);
    const apart = area.w / MARKS_A_CURVE;
    let next = area.x + apart * (seriesIndex + 0.5) / seriesCount;
    for (const {canvasx: x, canvasy: y} of points) {
      if (x < next || x > area.x + area.w || !Number.isFinite(y)) continue;
      drawMark(context, shape, x, y, colour);
      next = x + apart;
    }
  }

  /** Outside the plot: each curve's line, a box that shows or hides it, and its value. */
  addLegend(id, names) {
    const list = document.getElementById(id.replace("plot_", "legend_"));
    return names.map((name, i) => {
      const item = document.createElement("li"), label = document.createElement("label");
      const box = document.createElement("input"), value = document.createElement("output");
      box.type = "checkbox";
      box.checked = true;
      box.addEventListener("change", () => this.plots.find((one) => one.id === id)
        .plot.setVisibility(i, box.checked));
      label.append(...(names.length > 1 ? [box] : []), lineSample(lineStyle(i)), ` ${name} `);
      item.append(label, value);
      list.append(item);
      return value;
    });
  }

  /**
   * @param values  of row i, one a name
   * @param label   text of a tick of the upright axis, with its unit
   */
  add(id, names, values, {label, levels = [], ...options}) {
    const element = document.getElementById(id);
    const rows = this.data.samples.time_s.map((time, i) => [time, ...values(i)]);
    const {fillPlotter, errorPlotter, linePlotter} = Dygraph.Plotters;
    const series = {};
    names.forEach((name, i) => {
      series[name] = {strokePattern: lineStyle(i).dash.length > 0 ? lineStyle(i).dash : null};
    });
    const plot = new Dygraph(element, rows, {
      labels: ["s", ...names], colors: names.map((_, i) => lineStyle(i).colour), series,
      plotter: [fillPlotter, errorPlotter, linePlotter, (plotted) => this.drawMarks(plotted)],
      legend: "never", strokeWidth: 1.4, animatedZooms: false,
      highlightCircleSize: 2, fillAlpha: 0.2,
      axes: {y: {axisLabelWidth: 64, axisLabelFormatter: label},
             x: {axisLabelFormatter: (value) => `${value} s`}},
      clickCallback: (event, x) => this.goTo(x),
      zoomCallback: (from, to) => this.setRange(from, to),
      underlayCallback: (context, area, drawn) => {
        for (const level of levels) {
          const y = drawn.toDomYCoord(level);
          this.dash(context, area.x, y, area.x + area.w, y);
        }
      },
      ...options});
    const hair = document.createElement("b");
    hair.className = "hair";
    element.append(hair);
    this.plots.push({id, plot, hair, rows, outputs: this.addLegend(id, names)});
  }

  setRange(from, to) {
    for (const {plot} of this.plots) plot.updateOptions({dateWindow: [from, to]});
    this.setTime(this.time);
  }

  /** @param row  whose values the legends show */
  setTime(time, row = this.row) {
    this.time = time;
    this.row = row;
    for (const {plot, hair, rows, outputs} of this.plots) {
      outputs.forEach((output, i) => {
        const value = rows[row][i + 1], shown = Array.isArray(value) ? value[1] : value;
        output.textContent = shown === null ? "" : Number(shown.toPrecision(4)).toString();
      });
      const area = plot.getArea(), x = plot.toDomXCoord(time);
      hair.hidden = x < area.x || x > area.x + area.w;
      hair.style.left = `${x}px`;
    }
  }
}
