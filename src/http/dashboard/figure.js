/** The figure of one fault: its chart, its text summary and what its read-out says. */

import { drawChart, frame, isOutlier } from "./chart.js";
import { h } from "./dom.js";
import { amount, counted, faultLimit, faultSpread, faultValue, interval90, median, sentence, when } from "./format.js";
import { plotFigure } from "./plot.js";

/**
 * The figure of one fault. `model` is `{fault, unit, limit, now, reach, points, band, forecast, reasons, changes, events}`;
 * `reach` is how far ahead of now the usage axis looks;
 * a point is `{usage, value, std, recorded_at, earlier}`.
 */
export function figureOf(model) {
  const { fault, forecast, reasons } = model;
  const stops = stopsOf(model);
  return plotFigure({
    key: fault.symbol,
    title: `${fault.symbol}, ${fault.name}`,
    caption: [h("p", { class: "crossing" }, answer(model)), forecast && reasons.map((reason) => h("p", { class: "noted" }, sentence(reason)))],
    stops,
    initial: Math.max(stops.findLastIndex((stop) => !stop.ahead && stop.value !== null), 0),
    frame: (width) => frame(model, width),
    draw: (view) => drawChart(model, view, `clip-${fault.symbol}`, summaryOf(model)),
    say: (stop) => said(stop, model),
    level: (stop) => stop.value,
  });
}

function stopsOf({ points, band }) {
  const ahead = band.map((point) => ({ usage: point.usage, value: point.median, low: point.low, high: point.high, ahead: true }));
  return [...points, ...ahead].sort((a, b) => a.usage - b.usage || Boolean(a.ahead) - Boolean(b.ahead));
}

function said(stop, { fault, unit, changes }) {
  const value = (level) => faultValue(fault, level);
  const place = h("span", {}, `${stop.ahead ? "forecast at" : "at"} ${amount(stop.usage)} ${unit}`);
  if (stop.ahead) return [h("b", {}, value(stop.value)), h("span", {}, `90 %: ${faultValue(fault, stop.low, false)} to ${value(stop.high)}`), place];
  const time = h("span", {}, when(stop.recorded_at));
  if (stop.value === null) return [h("b", {}, "inconclusive"), place, time];
  return [
    h("b", {}, value(stop.value)), stop.std !== null && h("span", {}, `± ${faultSpread(fault, stop.std)}`),
    place, time, stop.earlier && h("span", {}, "earlier life"), isOutlier(stop, changes) && h("span", {}, "outlier"),
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
    answer(model), model.forecast && model.reasons.map(sentence).join(" "),
    maintained.length > 0 && `Maintenance: ${maintained.join(", ")}.`,
  ].filter(Boolean).join(" ");
}
