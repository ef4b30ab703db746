/** What every plot shares: ticks, axes, scales, and a figure whose read-out follows the pointer and the arrow keys. */

import { h, s } from "./dom.js";
import { fixed } from "./format.js";

/** The height of a plot, px. */
export const HEIGHT = 286;

const PAGE = 10;

/** Round tick values inside `low..high`, about `count` of them. */
export function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= raw);
  const values = [];
  for (let index = Math.ceil(low / step); index * step <= high + step * 1e-9; index += 1) values.push(index * step || 0);
  const decimals = [0, 1, 2, 3].find((count) => Math.abs(step * 10 ** count - Math.round(step * 10 ** count)) < 1e-9) ?? 4;
  return { values, decimals };
}

/** The view of a plot: its rectangle, its data ranges, and the maps `x` and `y` to pixels. */
export function viewOf(width, plot, range) {
  const along = ([low, high], [from, to]) => (value) => from + ((value - low) / (high - low)) * (to - from);
  return { width, height: HEIGHT, plot, range, x: along(range.x, [plot.left, plot.right]), y: along(range.y, [plot.bottom, plot.top]) };
}

/** The SVG of a plot with a clip path of this id, which is unique on the page; `label` is the plot in words. */
export function drawing({ plot, width, height }, id, label, ...layers) {
  return s("svg", { class: "chart", viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": label },
    s("defs", {}, s("clipPath", { id }, s("rect", { x: plot.left, y: plot.top, width: plot.right - plot.left, height: plot.bottom - plot.top }))),
    ...layers,
    s("g", { class: "cross" }));
}

/** Both axes with their titles. */
export function axes({ plot, range, height, x, y }, acrossTitle, upTitle) {
  const across = ticks(...range.x, Math.max(3, Math.floor((plot.right - plot.left) / 65)));
  const up = ticks(...range.y, 6);
  return s("g", { class: "axes" },
    up.values.map((value) => s("line", { class: "grid", x1: plot.left, x2: plot.right, y1: y(value), y2: y(value) })),
    up.values.map((value) => s("text", { x: plot.left - 8, y: y(value) + 4, "text-anchor": "end" }, fixed(value, up.decimals))),
    across.values.map((value) => s("line", { class: "tick", x1: x(value), x2: x(value), y1: plot.bottom, y2: plot.bottom + 4 })),
    across.values.map((value) => s("text", { x: x(value), y: plot.bottom + 16, "text-anchor": "middle" }, fixed(value, across.decimals))),
    s("line", { class: "base", x1: plot.left, x2: plot.right, y1: plot.bottom, y2: plot.bottom }),
    s("text", { class: "title", x: (plot.left + plot.right) / 2, y: height - 6, "text-anchor": "middle" }, acrossTitle),
    s("text", { class: "title", transform: `translate(12 ${(plot.top + plot.bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, upTitle));
}

/**
 * A figure with a heading and a read-out. `told` is `{key, title, caption, stops, initial, frame, draw, say, level, below}`: a stop
 * has a `usage`, `frame(width)` makes the view, `draw(view)` the SVG, `say(stop)` the read-out, `level(stop)` its height in
 * data or null; `below` follows the plot.
 */
export function plotFigure({ key, title, caption, stops, initial, frame, draw, say, level, below = [] }) {
  const readout = h("p", { class: "readout" });
  const holder = h("div", { class: "plot" });
  let index = initial;
  let view = null;

  const scrub = stops.length > 0 && h("div", {
    class: "scrub", role: "slider", tabindex: 0, "data-focus": `scrub-${key}`,
    "aria-label": `${title}, along usage`, "aria-valuemin": 0, "aria-valuemax": stops.length - 1,
  });

  function show(next, crossed) {
    index = Math.min(Math.max(next, 0), stops.length - 1);
    const stop = stops[index];
    readout.replaceChildren(...say(stop));
    scrub.setAttribute("aria-valuenow", index);
    scrub.setAttribute("aria-valuetext", [...readout.children].map((piece) => piece.textContent).join(", "));
    holder.querySelector(".cross")?.replaceChildren(...(crossed && view ? crosshair(stop.usage, level(stop), view) : []));
  }

  if (scrub) {
    scrub.addEventListener("pointermove", (event) => show(nearest(stops, view, event.offsetX), true));
    scrub.addEventListener("pointerdown", (event) => show(nearest(stops, view, event.offsetX), true));
    scrub.addEventListener("pointerleave", () => document.activeElement !== scrub && show(initial, false));
    scrub.addEventListener("focus", () => show(index, true));
    scrub.addEventListener("blur", () => show(initial, false));
    scrub.addEventListener("keydown", (event) => {
      const target = { ArrowRight: index + 1, ArrowUp: index + 1, ArrowLeft: index - 1, ArrowDown: index - 1, PageUp: index + PAGE, PageDown: index - PAGE, Home: 0, End: stops.length - 1 }[event.key];
      if (target === undefined) return;
      event.preventDefault();
      show(target, true);
    });
    show(initial, false);
  }

  new ResizeObserver(([entry]) => {
    const width = Math.floor(entry.contentRect.width);
    if (width === 0 || width === view?.width) return;
    view = frame(width);
    holder.replaceChildren(draw(view), ...(scrub ? [scrub] : []));
  }).observe(holder);
  return h("figure", { class: "figure-fault" }, h("figcaption", {}, h("h3", {}, title), caption), readout, holder, below);
}

function nearest(stops, view, pixel) {
  const distance = (stop) => Math.abs(view.x(stop.usage) - pixel);
  return stops.reduce((best, stop, index) => (distance(stop) < distance(stops[best]) ? index : best), 0);
}

function crosshair(usage, level, { plot, x, y }) {
  const at = x(usage);
  if (at > plot.right + 1) return [];
  const height = level === null ? null : y(level);
  const shown = height !== null && height >= plot.top;
  return [
    s("line", { x1: at, x2: at, y1: plot.top, y2: plot.bottom }),
    shown && s("line", { x1: plot.left, x2: plot.right, y1: height, y2: height }),
    shown && s("circle", { cx: at, cy: height, r: 5 }),
  ].filter(Boolean);
}
