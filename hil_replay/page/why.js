// SPDX-License-Identifier: Apache-2.0
// Why the guard stopped, or gave no permit: what the shown stop says in `why`
// (docs/reference/json.md), as a table with bars and as sentences.
"use strict";

const WHY_PARTS = [
  ["to_standstill_mm", "motion to standstill"],
  ["until_braking_mm", "motion until braking"],
  ["braking_mm", "braking"],
  ["position_error_mm", "uncertainty of position"],
  ["speed_uncertainty_mm", "uncertainty of speed"],
  ["margin_mm", "margin to keep"],
  ["arithmetic_mm", "arithmetic, stated errors"],
];

/** [label, mm, class] of each row; none where the stop is no matter of distance. */
function whyRows(why) {
  if (why.needed_mm === undefined) return [];
  const isFar = why.available_mm >= why.within_mm;
  return [
    ...WHY_PARTS.filter(([key]) => why[key] !== undefined).map(([key, label]) =>
      [label, why[key], ""]),
    ["needed", why.needed_mm, "sum"],
    [isFar ? "available, at least" : "available", why.available_mm, "has"],
  ];
}

/** What the table does not show. */
function whySentences(why) {
  const out = [], mm = (value) => `${value.toFixed(4)} mm`;
  if (why.worst_mm !== undefined) {
    const worst = why.worst_mm > 0 ? mm(why.worst_mm) : "a contact";
    out.push(`worst case found, to standstill: ${worst}`);
  }
  if (why.open) {
    out.push(`halving: ${why.queries} queries; the first part left open needs
              ${mm(why.open.needed_mm)} and has ${mm(why.open.available_mm)}`);
  }
  if (why.whole_reach) {
    const lists = Object.entries(why.whole_reach).filter(([, count]) => count > 0);
    out.push(`one query proves the whole reach, with ${
      lists.map(([name, count]) => `${name} ${count}`).join(", ") || "the boxes of both surfaces"}`);
  }
  if (why.full_list) out.push(`a list of the engine was full: ${why.full_list}`);
  if (!why.advice) return out;
  const {settings, tried} = why.advice;
  for (const one of settings) {
    const gain = one.gone ? `no stop for ${one.after_s.toFixed(1)} s`
                          : `${one.gain_mm.toFixed(2)} mm nearer`;
    out.push(`${gain} with these lines in the machine file: ${one.lines.join(" ")}`);
  }
  if (settings.length === 0) out.push(`${tried} other settings were run: none stops nearer`);
  return out;
}

/** Shows `why`, or hides the section where there is none. */
function writeWhy(why) {
  const byId = (id) => document.getElementById(id);
  byId("why_section").hidden = !why;
  if (!why) return;
  byId("why_sum").textContent = `${why.pair}: ${why.sentences.join("; ")}`;
  const rows = whyRows(why), most = Math.max(1e-9, ...rows.map(([, value]) => value));
  byId("why_parts").tBodies[0].replaceChildren(...rows.map(([label, value, name]) => {
    const row = document.createElement("tr"), head = document.createElement("th");
    const figure = document.createElement("td"), bar = document.createElement("td");
    const length = document.createElement("i");
    row.className = name;
    head.scope = "row";
    head.textContent = label;
    figure.textContent = `${value.toFixed(4)} mm`;
    length.style.width = `${100 * value / most}%`;
    bar.append(length);
    row.append(head, figure, bar);
    return row;
  }));
  byId("why_more").replaceChildren(...whySentences(why).map((sentence) => {
    const item = document.createElement("li");
    item.textContent = sentence.replace(/\s+/g, " ");
    return item;
  }));
  byId("reach_label").hidden = !why.reach_bodies;
}
