/** The small drawings inside a row: a value against its threshold, a remaining life on a shared scale. */

import { s } from "./dom.js";
import { amount } from "./format.js";

const THRESHOLD_AT = 0.8;
const WINDOW_UNLESS_TOLD = 100;

const share = (part) => `${(Math.min(Math.max(part, 0), 1) * 100).toFixed(2)}%`;

/** A thin bar: the value, one standard deviation to each side, and the threshold's mark. */
export function gauge(value, std, threshold) {
  const part = (level) => Math.min(Math.max((level / threshold) * THRESHOLD_AT, 0), 1);
  const at = (level) => share(part(level));
  const known = value !== null && value !== undefined;
  return s("svg", { class: "gauge", "aria-hidden": "true" },
    s("rect", { class: "track", y: 3, width: "100%", height: 4, rx: 2 }),
    known && s("rect", { class: value >= threshold ? "fill over" : "fill", y: 3, width: at(value), height: 4, rx: 2 }),
    known && std && s("rect", { class: "std", x: at(value - std), y: 2, width: share(part(value + std) - part(value - std)), height: 6 }),
    s("line", { class: "limit", x1: share(THRESHOLD_AT), x2: share(THRESHOLD_AT), y1: 0, y2: 10 }));
}

/** The logarithmic scale that every row shares: three decades of usage around the shortest risk window. */
export function lifeScale(rows) {
  const windows = rows.filter((row) => row.risk).map((row) => row.risk.within);
  const within = windows.length > 0 ? Math.min(...windows) : WINDOW_UNLESS_TOLD;
  const ticks = [0.1, 1, 10, 100].map((factor) => factor * within);
  return { low: ticks[0], high: ticks[3], ticks, within };
}

const along = (scale, life) => share(Math.log10(Math.max(life, scale.low) / scale.low) / Math.log10(scale.high / scale.low));

const short = (value) => (value >= 1000 ? `${amount(value / 1000).replace(".0", "")}k` : amount(value).replace(".0", ""));

/** The scale's tick labels, for the head of the column. */
export function lifeAxis(scale) {
  const anchors = scale.ticks.map((_, index) => (index === 0 ? "start" : index === scale.ticks.length - 1 ? "end" : "middle"));
  return s("svg", { class: "life-axis" },
    scale.ticks.map((tick, index) => s("text", { x: along(scale, tick), y: 10, "text-anchor": anchors[index] }, short(tick))));
}

/** Remaining life as a range: 90 % thin, 50 % thick, the median a dot; what lies beyond the scale or the horizon runs off to the right. */
export function lifeRange(life, scale) {
  const at = (level) => (life.quantiles[level] === null ? "100%" : along(scale, life.quantiles[level]));
  const open = life && (life.quantiles["0.95"] ?? Infinity) > scale.high;
  return s("svg", { class: "life", "aria-hidden": "true" },
    scale.ticks.map((tick) => s("line", { class: "grid", x1: along(scale, tick), x2: along(scale, tick), y1: 0, y2: 14 })),
    s("line", { class: "window", x1: along(scale, scale.within), x2: along(scale, scale.within), y1: 0, y2: 14 }),
    life && [
      s("line", { class: "range90", x1: at("0.05"), x2: at("0.95"), y1: 7, y2: 7 }),
      s("line", { class: "range50", x1: at("0.25"), x2: at("0.75"), y1: 7, y2: 7 }),
      life.quantiles["0.5"] !== null && s("circle", { class: "median", cx: at("0.5"), cy: 7, r: 4 }),
      open && s("svg", { x: "100%", class: "arrow" }, s("path", { d: "M-4 3 0 7-4 11" })),
    ]);
}
