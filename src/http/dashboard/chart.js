/** A fault against usage: observations, threshold, forecast, crossing quantiles, maintenance. */

import { s } from "./dom.js";
import { amount, faultLimit } from "./format.js";
import { HEIGHT, axes, drawing, viewOf } from "./plot.js";

const LANE = 13;
const TABULAR = 1.04;

// The future takes at least and at most this share of the history shown; the plot grows to at most so many thresholds.
const FUTURE_MIN = 0.25;
const FUTURE_MAX = 1.1;
const BAND_MAX = 1.35;
const EARLIER_MAX = 1.6;

const CROSSINGS = [["0.05", "P5"], ["0.5", "P50"], ["0.95", "P95"]];

const ruler = document.createElement("canvas").getContext("2d");

function widthOf(text, weight = 400) {
  ruler.font = `${weight} 11px ${getComputedStyle(document.body).fontFamily}`;
  return ruler.measureText(text).width * TABULAR;
}

/** The scales of a chart `width` wide: data ranges, plot rectangle, and the maps `x` and `y` to pixels. */
export function frame(model, width) {
  const { points, band, forecast, limit, events } = model;
  const plot = { left: 58, right: width - 14, top: 32, bottom: HEIGHT - (forecast && !forecast.reached ? 70 : 38) };
  const usages = [...points.map((point) => point.usage), ...events.map((event) => event.usage), model.now];
  const first = Math.min(...usages);
  const newest = Math.max(...usages);
  const span = newest - first || Math.max(newest, 1) * 0.5;
  const last = newest + Math.min(Math.max(model.reach * 1.12, span * FUTURE_MIN), span * FUTURE_MAX);
  const heights = [
    ...points.filter((point) => point.value !== null).map((point) => Math.min(point.value + (point.std ?? 0), point.earlier ? limit * EARLIER_MAX : Infinity)),
    ...band.filter((point) => point.usage <= last).map((point) => Math.min(point.high, limit * BAND_MAX)),
    limit * 1.12,
  ];
  const range = { x: [first - span * 0.02, last], y: [0, Math.max(...heights) * 1.03] };
  return viewOf(width, plot, range);
}

/** The whole drawing; `id` names its clip path and is unique on the page. */
export function drawChart(model, view, id, label) {
  return drawing(view, id, label,
    axes(view, `usage [${model.unit}]`, model.fault.axis),
    s("g", { "clip-path": `url(#${id})` }, forecast(model, view), observations(model, view)),
    threshold(model, view),
    verticals({ now: model.now, events: [...model.events, ...model.changes.filter(({ kind }) => kind !== "outlier")] }, view),
    model.forecast && !model.forecast.reached && crossings(model, view));
}

function forecast({ band }, { x, y }) {
  if (band.length < 2) return null;
  const path = (points) => points.map(([usage, value]) => `${x(usage).toFixed(1)} ${y(value).toFixed(1)}`).join("L");
  const upper = band.map((point) => [point.usage, point.high]);
  const lower = band.map((point) => [point.usage, point.low]).reverse();
  return s("g", { class: "forecast" },
    s("path", { class: "band", d: `M${path([...upper, ...lower])}Z` }),
    s("path", { class: "edge", d: `M${path(upper)}M${path(lower)}` }),
    s("path", { class: "middle", d: `M${path(band.map((point) => [point.usage, point.median]))}` }));
}

/** Whether the forecast takes an observation for an outlier. */
export function isOutlier(point, changes) {
  return !point.earlier && point.value !== null && changes.some(({ kind, usage }) => kind === "outlier" && usage === point.usage);
}

function observations({ points, changes }, { plot, x, y }) {
  return s("g", { class: "observations" }, points.map((point) => {
    const at = x(point.usage);
    const tone = point.earlier ? "earlier" : "current";
    if (point.value === null) return s("path", { class: `missing ${tone}`, d: `M${at - 3} ${plot.bottom - 9}l6 6m0-6l-6 6` });
    return s("g", { class: tone },
      point.std && s("line", { x1: at, x2: at, y1: y(point.value - point.std), y2: y(point.value + point.std) }),
      s("circle", { cx: at, cy: y(point.value), r: 2.5 }),
      isOutlier(point, changes) && s("circle", { class: "outlier", cx: at, cy: y(point.value), r: 7 }));
  }));
}

function threshold({ fault, limit }, { plot, y }) {
  return s("g", { class: "threshold" },
    s("line", { x1: plot.left, x2: plot.right, y1: y(limit), y2: y(limit) }),
    s("text", { x: plot.left + 6, y: y(limit) - 5 }, `threshold ${faultLimit(fault, limit)}`));
}

/** Maintenance and the present, labelled above the plot in two lanes; a label without room is left to the read-out and the list. */
export function verticals({ events, now }, { plot, range, x }) {
  const lines = [...events.map((event) => ({ ...event, text: `${event.kind} ${amount(event.usage)}` })), { kind: "now", usage: now, text: `now ${amount(now)}` }]
    .filter(({ usage }) => usage >= range.x[0] && usage <= range.x[1]);
  const taken = [[], []];
  const order = lines.toSorted((a, b) => (b.kind === "now") - (a.kind === "now") || (b.kind === "replaced") - (a.kind === "replaced") || b.usage - a.usage);
  const placed = order.map(({ kind, usage, text }) => {
    const half = widthOf(text) / 2;
    const centre = clamp(x(usage), plot.left + half - 40, plot.right - half + 8);
    const lane = taken.findIndex((spans) => spans.every(([low, high]) => centre + half + 4 < low || centre - half - 4 > high));
    if (lane >= 0) taken[lane].push([centre - half, centre + half]);
    return { kind, text, centre, lane, at: x(usage), top: plot.top - 4 - (lane === 1 ? LANE : 0) };
  });
  return s("g", { class: "verticals" },
    placed.map(({ kind, at, top }) => s("line", { class: kind, x1: at, x2: at, y1: top, y2: plot.bottom })),
    placed.filter(({ lane }) => lane >= 0).map(({ kind, text, centre, top }) => s("text", { class: kind, x: centre, y: top - 3, "text-anchor": "middle" }, text)));
}

/** The usage at which the threshold is passed: P5 to P95 as a bar under the axis, each quantile written below. */
function crossings({ forecast: { at, quantiles, horizon }, limit }, { plot, range, x, y }) {
  const lane = plot.bottom + 29;
  if (quantiles["0.05"] === null) {
    return s("g", { class: "crossings" }, s("text", { x: plot.right, y: lane + 10, "text-anchor": "end" }, `passes beyond ${amount(at + horizon)} →`));
  }
  const marks = CROSSINGS.map(([level, name]) => {
    const usage = quantiles[level] === null ? Infinity : at + quantiles[level];
    const shown = usage <= range.x[1];
    const text = quantiles[level] === null ? `${name} > ${amount(at + horizon)}` : `${name} ${amount(usage)}${shown ? "" : " →"}`;
    return { text, shown, at: shown ? x(usage) : plot.right, width: widthOf(text, 600) };
  });
  const places = spread(marks, plot.left - 40, plot.right + 8);
  return s("g", { class: "crossings" },
    s("line", { class: "span", x1: marks[0].at, x2: marks[2].at, y1: lane, y2: lane }),
    !marks[2].shown && s("path", { class: "more", d: `M${plot.right - 1} ${lane - 4}l5 4-5 4` }),
    marks.map((mark, index) => [
      mark.shown && s("line", { class: index === 1 ? "drop median" : "drop", x1: mark.at, x2: mark.at, y1: y(limit), y2: plot.bottom }),
      mark.shown && s("circle", { cx: mark.at, cy: lane, r: index === 1 ? 4 : 2.5 }),
      s("text", { class: index === 1 ? "median" : null, x: places[index], y: lane + 17, "text-anchor": "middle" }, mark.text),
    ]));
}

/** Centres for labels that stand in order and never overlap, each as near to its mark as the others allow. */
function spread(marks, low, high) {
  const gap = 8;
  const centres = marks.map((mark) => mark.at);
  const start = (index) => (index === 0 ? low : centres[index - 1] + marks[index - 1].width / 2 + gap);
  const end = (index) => (index === marks.length - 1 ? high : centres[index + 1] - marks[index + 1].width / 2 - gap);
  const middle = Math.floor(marks.length / 2);
  const room = (from, to) => marks.slice(from, to).reduce((sum, mark) => sum + mark.width + gap, 0);
  centres[middle] = clamp(centres[middle], low + room(0, middle) + marks[middle].width / 2, high - room(middle + 1, marks.length) - marks[middle].width / 2);
  for (let index = middle - 1; index >= 0; index -= 1) centres[index] = clamp(centres[index], low + room(0, index) + marks[index].width / 2, end(index) - marks[index].width / 2);
  for (let index = middle + 1; index < marks.length; index += 1) centres[index] = clamp(centres[index], start(index) + marks[index].width / 2, high - marks[index].width / 2);
  return centres;
}

function clamp(value, low, high) {
  return Math.max(Math.min(value, high), low);
}
