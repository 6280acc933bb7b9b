// SPDX-License-Identifier: Apache-2.0
// The plots over time, linked: one range of time, one hair line, a click goes there. dygraphs draws.
"use strict";

const LINE_COLOURS = ["#1d6fa5", "#2a9d8f", "#e09f3e", "#a4161a", "#7b4fa3", "#5c6b7a", "#b5651d",
                      "#3a7d44", "#c2185b", "#00838f"];

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
    if (data.samples.cycle_us.some((value) => value !== null)) {
      this.addCycles();
      this.addHistogram();
    } else {
      for (const id of ["title_cycles", "plot_cycles", "title_histogram", "plot_histogram"]) {
        document.getElementById(id).hidden = true;
      }
    }
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
             {valueRange: [0, within], levels: margins});
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
    const {permit} = this.data.samples;
    this.add("plot_permit", ["permit"], (i) => [permit[i]],
             {stepPlot: true, fillGraph: true, valueRange: [0, 1.15], colors: ["#2d6a4f"]});
  }

  addCycles() {
    const spent = this.data.samples.cycle_us;
    this.add("plot_cycles", ["slowest"], (i) => [spent[i]],
             {levels: [this.data.deadline_us], logscale: true});
  }

  addHistogram() {
    const rows = this.data.cycle_times_us;
    const element = document.getElementById("plot_histogram");
    this.histogram = new Dygraph(element, rows, {
      labels: ["us", "cycles"], logscale: true, stepPlot: true, fillGraph: true,
      axes: {x: {logscale: true}, y: {axisLabelWidth: 44}}, colors: ["#1d6fa5"],
      legend: "never", dateWindow: [0.9 * rows[0][0],
                                    1.2 * Math.max(rows[rows.length - 1][0], this.data.deadline_us)],
      underlayCallback: (context, area, plot) => {
        const x = plot.toDomXCoord(this.data.deadline_us);
        this.dash(context, x, area.y, x, area.y + area.h);
      }});
  }

  addBands(id, names, values, valueRange) {
    this.add(id, names, values, {customBars: true, ...(valueRange ? {valueRange} : {})});
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

  /** @param values  of row i, one a name */
  add(id, names, values, {levels = [], ...options}) {
    const element = document.getElementById(id);
    const rows = this.data.samples.time_s.map((time, i) => [time, ...values(i)]);
    const plot = new Dygraph(element, rows, {
      labels: ["s", ...names], colors: names.map((_, i) => LINE_COLOURS[i % LINE_COLOURS.length]),
      legend: "always", labelsSeparateLines: false, strokeWidth: 1.2, animatedZooms: false,
      highlightCircleSize: 2, fillAlpha: 0.2,
      axes: {y: {axisLabelWidth: 44}, x: {axisLabelFormatter: (value) => String(value)}},
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
    this.plots.push({plot, hair});
  }

  setRange(from, to) {
    for (const {plot} of this.plots) plot.updateOptions({dateWindow: [from, to]});
    this.setTime(this.time);
  }

  setTime(time) {
    this.time = time;
    for (const {plot, hair} of this.plots) {
      const area = plot.getArea(), x = plot.toDomXCoord(time);
      hair.hidden = x < area.x || x > area.x + area.w;
      hair.style.left = `${x}px`;
    }
  }
}
