/** A chart with its heading, text summary and read-out that follows the pointer and the arrow keys. */

import { drawChart, frame } from "./chart.js";
import { h, s } from "./dom.js";
import { amount, counted, faultLimit, faultSpread, faultValue, interval90, median, when } from "./format.js";

const PAGE = 10;

/**
 * The figure of one fault. `model` is `{fault, unit, limit, now, reach, points, band, forecast, reasons, events}`;
 * `reach` is how far ahead of now the usage axis looks;
 * a point is `{usage, value, std, recorded_at, earlier}`.
 */
export function figureOf(model) {
  const stops = stopsOf(model);
  const readout = h("p", { class: "readout" });
  const holder = h("div", { class: "plot" });
  const figure = h("figure", { class: "figure-fault" },
    h("figcaption", {}, h("h3", {}, `${model.fault.symbol}, ${model.fault.name}`), h("p", { class: "crossing" }, answer(model))),
    readout, holder);
  const initial = Math.max(stops.findLastIndex((stop) => !stop.ahead && stop.value !== null), 0);
  let index = initial;
  let view = null;

  const scrub = stops.length > 0 && h("div", {
    class: "scrub", role: "slider", tabindex: 0, "data-focus": `scrub-${model.fault.symbol}`,
    "aria-label": `${model.fault.symbol} along usage`, "aria-valuemin": 0, "aria-valuemax": stops.length - 1,
  });

  function show(next, crossed) {
    index = Math.min(Math.max(next, 0), stops.length - 1);
    const stop = stops[index];
    readout.replaceChildren(...said(stop, model));
    scrub.setAttribute("aria-valuenow", index);
    scrub.setAttribute("aria-valuetext", [...readout.children].map((piece) => piece.textContent).join(", "));
    holder.querySelector(".cross")?.replaceChildren(...(crossed && view ? crosshair(stop, view) : []));
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
    view = frame(model, width);
    holder.replaceChildren(drawChart(model, view, `clip-${model.fault.symbol}`, summaryOf(model)), ...(scrub ? [scrub] : []));
  }).observe(holder);
  return figure;
}

function stopsOf({ points, band }) {
  const ahead = band.map((point) => ({ usage: point.usage, value: point.median, low: point.low, high: point.high, ahead: true }));
  return [...points, ...ahead].sort((a, b) => a.usage - b.usage || Boolean(a.ahead) - Boolean(b.ahead));
}

function nearest(stops, view, pixel) {
  const distance = (stop) => Math.abs(view.x(stop.usage) - pixel);
  return stops.reduce((best, stop, index) => (distance(stop) < distance(stops[best]) ? index : best), 0);
}

function crosshair(stop, { plot, x, y }) {
  const at = x(stop.usage);
  if (at > plot.right + 1) return [];
  const height = stop.value === null ? null : y(stop.value);
  return [
    s("line", { x1: at, x2: at, y1: plot.top, y2: plot.bottom }),
    height !== null && height >= plot.top && s("line", { x1: plot.left, x2: plot.right, y1: height, y2: height }),
    height !== null && height >= plot.top && s("circle", { cx: at, cy: height, r: 5 }),
  ].filter(Boolean);
}

function said(stop, { fault, unit }) {
  const value = (level) => faultValue(fault, level);
  const place = h("span", {}, `${stop.ahead ? "forecast at" : "at"} ${amount(stop.usage)} ${unit}`);
  if (stop.ahead) return [h("b", {}, value(stop.value)), h("span", {}, `90 %: ${faultValue(fault, stop.low, false)} to ${value(stop.high)}`), place];
  const time = h("span", {}, when(stop.recorded_at));
  if (stop.value === null) return [h("b", {}, "inconclusive"), place, time];
  return [
    h("b", {}, value(stop.value)), stop.std !== null && h("span", {}, `± ${faultSpread(fault, stop.std)}`),
    place, time, stop.earlier && h("span", {}, "earlier life"),
  ].filter(Boolean);
}

function answer({ forecast, reasons, unit }) {
  if (!forecast) return `No forecast${reasons.length > 0 ? `: ${reasons.join("; ")}` : ""}.`;
  if (forecast.reached) return "Threshold passed.";
  if (forecast.quantiles["0.05"] === null) return `Passes ${median(forecast)} ${unit}.`;
  return `Passes ${forecast.quantiles["0.5"] === null ? "" : "in "}${median(forecast)} ${unit} (90 %: ${interval90(forecast)}).`;
}

/** The chart in words, for those who cannot see it. */
function summaryOf(model) {
  const { fault, points, events, limit, unit, now } = model;
  const known = points.filter((point) => point.value !== null);
  const newest = known.at(-1);
  const history = newest
    ? `${counted(known.length, "observation")} from ${amount(known[0].usage)} to ${amount(newest.usage)} ${unit}; newest ${faultValue(fault, newest.value)}`
    : "no conclusive observation";
  const maintained = events.map((event) => `${event.kind} at ${amount(event.usage)} ${unit}`);
  return [
    `${fault.symbol} against usage: ${history}; threshold ${faultLimit(fault, limit)}; now ${amount(now)} ${unit}.`,
    answer(model),
    maintained.length > 0 && `Maintenance: ${maintained.join(", ")}.`,
  ].filter(Boolean).join(" ");
}
