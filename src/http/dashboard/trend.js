/** How the forecast of the remaining life moved with usage, life by life. */

import { verticals } from "./chart.js";
import { h, s } from "./dom.js";
import { amount, counted, fixed, unitName, when } from "./format.js";
import { HEIGHT, axes, drawing, plotFigure, viewOf } from "./plot.js";

// The plot grows to at most so many middle medians: what an early forecast says beyond that runs out of it.
const TALLEST = 3;
const DOTS_MAX = 150;
const TABLE_MAX = 200;

/** The figure of a trend's rows, sorted life by life; `maintenance` tells what began each life. */
export function trendFigure(rows, maintenance, usageUnit) {
  const unit = unitName(usageUnit);
  const lives = livesOf(rows);
  const stops = lives.flatMap((life) => life.stops);
  const newest = lives.at(-1);
  const begun = maintenance.filter((event) => event.kind !== "inspected");
  const model = { unit, lives, stops, top: topOf(lives, stops), events: begun.map(({ kind, usage }) => ({ kind, usage })), now: newest.stops.at(-1).usage };
  return plotFigure({
    key: "trend",
    title: "Trend of the remaining life",
    caption: h("p", { class: "crossing" }, agreement(newest, unit)),
    stops,
    initial: stops.length - 1,
    frame: (width) => frame(model, width),
    draw: (view) => draw(model, view),
    say: (stop) => said(stop, unit),
    level: (stop) => stop.middle,
    below: [key(model), table(model)],
  });
}

/** Where there is no trend: why, and what makes one. */
export function noTrend(problem) {
  return h("section", { class: "block" },
    h("h3", {}, "Trend of the remaining life"),
    h("p", problem ? { class: "failure", role: "alert" } : { class: "hint" },
      problem ? `The trend could not be read. ${problem.title}: ${problem.detail}` : "None yet: every estimate leaves a forecast here, and two of them make a trend."));
}

/**
 * The lives as `{stops, end}`; a stop's quantiles are null beyond the horizon, all of it is unknown where no forecast could be
 * made. `end` is the usage at which the life ends by the median of its newest forecast, or by the first of those that hold the
 * threshold for passed.
 */
function livesOf(rows) {
  const starts = [...new Set(rows.map((row) => row.life_started_at))];
  return starts.map((start, index) => {
    const stops = rows.filter((row) => row.life_started_at === start).map(({ usage, as_of: asOf, forecast }) => ({
      usage, asOf, known: forecast !== null, reached: forecast?.reached ?? false, earlier: index < starts.length - 1,
      low: forecast?.quantiles["0.05"] ?? null, middle: forecast?.quantiles["0.5"] ?? null, high: forecast?.quantiles["0.95"] ?? null,
    }));
    const told = stops[Math.min(stops.findLastIndex((stop) => !stop.reached) + 1, stops.length - 1)];
    return { stops, end: told.middle === null ? null : told.usage + told.middle };
  });
}

/** How well the earlier forecasts of a life agree with its newest. */
function agreement({ stops, end }, unit) {
  if (end === null) return "The newest forecast gives no median: it cannot judge the earlier ones.";
  const earlier = stops.slice(0, -1).filter((stop) => stop.low !== null && stop.usage < end);
  const holding = earlier.filter((stop) => stop.usage + stop.low <= end && (stop.high === null || end <= stop.usage + stop.high));
  const newest = `The newest forecast puts the end of this life at ${amount(end)} ${unit}`;
  return earlier.length === 0 ? `${newest}.` : `${newest}; ${holding.length} of ${counted(earlier.length, "earlier 90 % interval")} ${holding.length === 1 ? "holds" : "hold"} it.`;
}

/** How high the plot goes: over what the newest forecasts imply, and over the medians unless a few tower above the rest. */
function topOf(lives, stops) {
  const medians = stops.map((stop) => stop.middle).filter((middle) => middle !== null).sort((a, b) => a - b);
  const ideal = lives.filter((life) => life.end !== null).map((life) => life.end - life.stops[0].usage);
  const known = medians.length > 0 ? Math.min(medians.at(-1), TALLEST * medians[Math.floor(medians.length / 2)]) : Math.max(...stops.map((stop) => stop.low ?? 0));
  return Math.max(...ideal, known) * 1.15 || 1;
}

function frame({ stops, events, top }, width) {
  const plot = { left: 28 + 6 * Math.max(fixed(top, 0).length, 5), right: width - 14, top: 32, bottom: HEIGHT - 38 };
  const usages = [...stops, ...events].map((each) => each.usage);
  const [first, last] = [Math.min(...usages), Math.max(...usages)];
  const span = last - first || Math.max(last, 1) * 0.5;
  return viewOf(width, plot, { x: [first - span * 0.03, last + span * 0.03], y: [0, top] });
}

function draw(model, view) {
  const { lives, stops, unit } = model;
  return drawing(view, "clip-trend", spoken(model),
    axes(view, `usage [${unit}]`, `remaining life [${unit}]`),
    s("g", { "clip-path": "url(#clip-trend)" }, lives.map((life) => curves(life, view, stops.length <= DOTS_MAX))),
    s("g", { class: "open-marks" }, stops.map((stop) => openMark(stop, view))),
    verticals(model, view));
}

/** The parts of a life without a gap between them. */
function runs(stops, holds) {
  const found = [];
  stops.forEach((stop, index) => {
    if (!holds(stop)) return;
    if (index === 0 || !holds(stops[index - 1])) found.push([]);
    found.at(-1).push(stop);
  });
  return found;
}

/** The band up to the plot's top where its upper bound lies beyond the horizon, without an edge there. */
function curves({ stops, end }, { range, x, y }, dots) {
  const path = (points) => points.map(([usage, life]) => `${x(usage).toFixed(1)} ${y(life).toFixed(1)}`).join("L");
  const line = (run, level) => `M${path(run.map((stop) => [stop.usage, level(stop)]))}`;
  const bands = runs(stops, (stop) => stop.low !== null);
  const upper = (stop) => stop.high ?? range.y[1] * 2;
  const [from, to] = [stops[0].usage, Math.min(stops.at(-1).usage, end ?? -Infinity)];
  return s("g", { class: stops[0].earlier ? "trend earlier" : "trend" },
    bands.map((run) => s("path", { class: "band", d: `${line(run, upper)}L${path(run.toReversed().map((stop) => [stop.usage, stop.low]))}Z` })),
    bands.map((run) => s("path", { class: "edge", d: line(run, (stop) => stop.low) })),
    runs(stops, (stop) => stop.high !== null).map((run) => s("path", { class: "edge", d: line(run, (stop) => stop.high) })),
    bands.filter((run) => run.length === 1).map(([stop]) => s("line", { class: "edge", x1: x(stop.usage), x2: x(stop.usage), y1: y(stop.low), y2: y(upper(stop)) })),
    to > from && s("path", { class: "ideal", d: `M${path([[from, end - from], [to, end - to]])}` }),
    runs(stops, (stop) => stop.middle !== null).map((run) => s("path", { class: "middle", d: line(run, (stop) => stop.middle) })),
    dots && stops.filter((stop) => stop.middle !== null).map((stop) => s("circle", { cx: x(stop.usage), cy: y(stop.middle), r: 2.5 })));
}

/** At the top: a median beyond the horizon (hollow) or above the scale (filled); at the bottom, a cross: no forecast. */
function openMark(stop, { plot, range, x }) {
  const at = x(stop.usage);
  if (!stop.known) return s("path", { class: "missing", d: `M${at - 3} ${plot.bottom - 9}l6 6m0-6l-6 6` });
  if (stop.middle === null) return s("path", { class: "beyond", d: `M${at - 4} ${plot.top + 9}h8l-4-7z` });
  return stop.middle > range.y[1] && s("path", { class: "above", d: `M${at - 4} ${plot.top + 9}h8l-4-7z` });
}

function key({ lives, stops, top }) {
  const mark = (...pieces) => s("svg", { class: "chart swatch", width: 26, height: 12, "aria-hidden": "true" }, s("g", { class: "trend open-marks" }, pieces));
  const entry = (swatch, text) => h("li", {}, swatch, h("span", {}, text));
  return h("ul", { class: "key" },
    entry(mark(s("rect", { class: "band", width: 26, height: 12 }), s("line", { class: "middle", x1: 0, x2: 26, y1: 6, y2: 6 })), "median and 5 to 95 %; up to the top: beyond the horizon"),
    lives.some((life) => life.end !== null) && entry(mark(s("line", { class: "ideal", x1: 0, x2: 26, y1: 6, y2: 6 })), "how right forecasts would have moved if the newest is right (slope −1)"),
    stops.some((stop) => stop.known && stop.middle === null) && entry(mark(s("path", { class: "beyond", d: "M9 10h8l-4-7z" })), "median beyond the horizon"),
    stops.some((stop) => stop.middle > top) && entry(mark(s("path", { class: "above", d: "M9 10h8l-4-7z" })), "median above the scale"),
    stops.some((stop) => !stop.known) && entry(mark(s("path", { class: "missing", d: "M10 3l6 6m0-6l-6 6" })), "no forecast"));
}

const life = (value) => (value === null ? "beyond the horizon" : amount(value));

function said(stop, unit) {
  const pieces = [
    stop.known ? h("b", {}, stop.middle === null ? "median beyond the horizon" : `median ${life(stop.middle)}`) : h("b", {}, "no forecast"),
    stop.known && stop.low !== null && h("span", {}, `90 %: ${life(stop.low)} to ${life(stop.high)}`),
    h("span", {}, `at ${amount(stop.usage)} ${unit}`), h("span", {}, when(stop.asOf)),
    stop.reached && h("span", {}, "threshold passed"), stop.earlier && h("span", {}, "earlier life"),
  ];
  return pieces.filter(Boolean);
}

/** The plot in words, for those who cannot see it. */
function spoken({ lives, stops, unit }) {
  const newest = stops.at(-1);
  const range = `${counted(stops.length, "forecast")} in ${counted(lives.length, "life", "lives")}, from ${amount(stops[0].usage)} to ${amount(newest.usage)} ${unit}`;
  const last = newest.known ? `the newest median is ${life(newest.middle)}, its 5 % quantile ${life(newest.low)}, its 95 % quantile ${life(newest.high)}` : "the newest could not be made";
  return `Remaining life against usage: ${range}; ${last}. ${agreement(lives.at(-1), unit)} The same figures follow as a table.`;
}

function table({ stops, unit }) {
  const cell = (stop, value) => h("td", {}, stop.known ? (value === null ? "beyond" : amount(value)) : "–");
  const heads = ["Recorded", ["Usage ", h("small", {}, `[${unit}]`)], "5 %", "Median", "95 %"];
  const shown = stops.slice(-TABLE_MAX).toReversed();
  return h("details", { class: "figures" },
    h("summary", { "data-focus": "trend-table" }, "The trend as a table"),
    h("p", { class: "hint" }, `Remaining life [${unit}], newest first${shown.length < stops.length ? `; the newest ${shown.length} of ${stops.length}` : ""}.`),
    h("div", { class: "scroller", tabindex: 0, role: "region", "aria-label": "Trend table" }, h("table", {},
      h("thead", {}, h("tr", {}, heads.map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, shown.map((stop) => h("tr", { class: stop.earlier ? "earlier" : null },
        h("td", { class: "time" }, when(stop.asOf)), h("td", {}, amount(stop.usage)),
        cell(stop, stop.low), cell(stop, stop.middle), cell(stop, stop.high)))))));
}
