/** One actuator: the answer, the charts, the history, maintenance, and where the figures come from. */

import { badge, command } from "./fleet.js";
import { h, reconcile } from "./dom.js";
import { figureOf } from "./figure.js";
import { FAULTS, amount, faultGrowth, faultLimit, faultSpread, faultValue, fixed, interval90, median, percent, unitName, when } from "./format.js";
import { statusOf } from "./status.js";
import { lifeStrip } from "./strip.js";

const HISTORY_AT_FIRST = 12;
const HISTORY_MORE = 50;

/** Draws `detail {record, history, life, maintenance, truncated}` into a container; `open` is how many records its table shows. */
export function drawActuator(container, detail, open, showMore) {
  const { record, history, life, maintenance } = detail;
  const starts = maintenance.filter((event) => event.kind !== "inspected").map((event) => event.usage);
  const lifeStart = Math.max(-Infinity, ...starts);
  const shown = open || HISTORY_AT_FIRST;
  const grown = sinceNew(history, lifeStart);
  reconcile(container, [
    { key: "head", data: [record, life, history.at(-1), grown], draw: () => head(record, life, history, grown) },
    ...(history.length === 0 ? [{ key: "none", data: record.id, draw: () => noRecords(record) }] : []),
    ...(history.length === 0 ? [] : byUrgency(life)).map((fault) => {
      const model = modelOf(fault, detail, lifeStart);
      return { key: fault.value, data: model, draw: () => figureOf(model) };
    }),
    ...(history.length === 0 ? [] : [{ key: "history", data: [history, shown, lifeStart], draw: () => historyTable(detail, shown, lifeStart, showMore) }]),
    { key: "maintenance", data: maintenance, draw: () => maintenanceList(record, maintenance) },
    { key: "facts", data: [record, life], draw: () => facts(record, life) },
  ]);
}

/** Both charts of an actuator share one usage axis, so that they can be read one above the other. */
function modelOf(fault, { record, history, life, maintenance }, lifeStart) {
  const forecast = life.faults[fault.value];
  const reaches = Object.values(life.faults).filter((other) => other.forecast).map((other) => other.forecast.quantiles["0.95"] ?? other.forecast.horizon);
  return {
    fault,
    unit: unitName(record.usage_unit),
    limit: forecast.threshold,
    now: life.usage ?? history.at(-1).usage,
    reach: Math.max(0, ...reaches),
    points: history.map((item) => ({
      usage: item.usage, value: item[fault.value], std: item[fault.std], recorded_at: item.recorded_at, earlier: item.usage < lifeStart,
    })),
    band: forecast.band ?? [],
    forecast: forecast.forecast,
    reasons: forecast.reasons,
    events: maintenance.map(({ kind, usage }) => ({ kind, usage })),
  };
}

/**
 * The faults in the order in which their thresholds are likely to be passed: the limiting one first. As in the fleet's
 * order, risks are compared in whole percents.
 */
function byUrgency(life) {
  const percent = (risk) => Math.round(100 * (risk?.probability ?? 0));
  const rank = ({ forecast, risk }) => (forecast
    ? [forecast.reached ? 0 : 1, -percent(risk), forecast.quantiles["0.5"] ?? Infinity, forecast.quantiles["0.05"] ?? Infinity]
    : [2]);
  return Object.values(FAULTS).toSorted((a, b) => {
    const [left, right] = [a, b].map((fault) => rank(life.faults[fault.value]));
    const differing = left.findIndex((value, index) => value !== right[index]);
    return differing < 0 ? 0 : left[differing] - right[differing];
  });
}

/** The way back to the list, where the list is not beside the actuator. */
export function back() {
  return h("a", { class: "back", href: "#/" }, "Fleet");
}

/** The growth since the baseline of this life, of the newest record that tells it: `Since delivery: KGM +0.050 ± 0.002, ...`. */
function sinceNew(history, lifeStart) {
  const told = (item) => !(item.usage < lifeStart) && Object.values(FAULTS).some(({ value }) => item[`${value}_growth`] !== null);
  const newest = history.findLast(told);
  if (!newest) return "";
  const parts = Object.values(FAULTS).filter(({ value }) => newest[`${value}_growth`] !== null)
    .map((fault) => `${fault.symbol} ${faultGrowth(fault, newest[`${fault.value}_growth`], newest[`${fault.value}_growth_std`])}`);
  return `Since ${lifeStart > -Infinity ? "this life began" : "delivery"}: ${parts.join(", ")}.`;
}

function head(record, life, history, grown) {
  const status = statusOf({ remaining_life: life.forecast, risk: life.risk });
  return h("header", { class: "detail-head" },
    back(),
    h("p", { class: "identity" }, h("b", {}, record.serial_number), h("span", {}, record.tail_number), h("span", {}, record.location), badge(status)),
    ...headline(life, history, unitName(record.usage_unit)),
    grown && h("p", { class: "because" }, grown),
    life.forecast && !life.forecast.reached && life.forecast.quantiles["0.05"] !== null && lifeStrip(life.forecast, life.risk, unitName(record.usage_unit)));
}

function headline(life, history, unit) {
  const { forecast, risk } = life;
  if (!forecast) return [h("h2", {}, "No forecast yet"), h("p", { class: "because" }, life.reasons.join("; ") || "There are too few conclusive records.")];
  const [fault] = byUrgency(life);
  const limit = life.faults[fault.value].forecast && `Limiting fault: ${fault.name} (${fault.symbol}).`;
  const chance = risk && `${percent(risk.probability)} likely to pass within ${amount(risk.within)} ${unit}.`;
  const asOf = `As of ${amount(life.usage)} ${unit}${life.as_of ? `, ${when(life.as_of)}` : ""}.`;
  if (forecast.reached) {
    const passed = Object.values(FAULTS).filter(({ value }) => life.faults[value].forecast?.reached);
    return [
      h("h2", { class: "past" }, ["Past its threshold", passed.map(({ name }) => name).join(" and ")].filter(Boolean).join(": ")),
      h("p", { class: "because" }, [...passed.map((each) => measured(each, history, life.faults[each.value].threshold)), asOf].join(" ")),
    ];
  }
  return [
    h("h2", {}, "Median remaining life ", h("span", { class: "together" }, `${median(forecast)} ${unit}`), " ",
      forecast.quantiles["0.05"] !== null && h("span", { class: "interval" }, `(90 %: ${interval90(forecast)})`)),
    h("p", { class: "because" }, [limit, chance, asOf].filter(Boolean).join(" ")),
    life.reasons.length > 0 && h("p", { class: "because" }, life.reasons.join("; ")),
  ].filter(Boolean);
}

function measured(fault, history, limit) {
  const newest = history.findLast((item) => item[fault.value] !== null);
  return newest ? `${fault.symbol} ${faultValue(fault, newest[fault.value])} against ${faultLimit(fault, limit)}.` : "";
}

function noRecords(record) {
  const query = `recorded_at=${new Date().toISOString().slice(0, 10)}T00:00:00Z&usage=10`;
  return h("div", { class: "empty" },
    h("h3", {}, "No record yet"),
    h("p", {}, "Upload the first trace; its estimate follows by itself."),
    command(`curl -X POST '${location.origin}/v1/actuators/${record.id}/traces?${query}' \\\n  -H 'Content-Type: text/csv' --data-binary @trace.csv`));
}

function historyTable({ record, history, truncated }, shown, lifeStart, showMore) {
  const newestFirst = history.toReversed();
  const left = newestFirst.length - shown;
  const more = left > HISTORY_MORE ? `Show ${HISTORY_MORE} more of ${left}` : `Show the other ${left}`;
  const heads = ["Recorded", ["Usage ", h("small", {}, `[${unitName(record.usage_unit)}]`)], ...Object.values(FAULTS).map(({ axis }) => axis), "Verdict"];
  const rows = newestFirst.slice(0, shown).flatMap((item, index) => {
    const earlier = item.usage < lifeStart;
    const parts = earlier && !(newestFirst[index - 1]?.usage < lifeStart);
    return [parts && parting(lifeStart, record.usage_unit), historyRow(item, earlier)];
  });
  return h("section", { class: "block" },
    h("h3", {}, "History"),
    h("div", { class: "scroller", tabindex: 0, role: "region", "aria-label": "History table" }, h("table", {},
      h("thead", {}, h("tr", {}, heads.map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, rows))),
    left > 0 && h("button", { type: "button", class: "quiet wide", "data-focus": "more-history", onclick: () => showMore(shown + HISTORY_MORE) }, more),
    truncated && h("p", { class: "hint" }, `Only the first ${fixed(history.length, 0)} records were read; the raw JSON has the rest.`));
}

function parting(lifeStart, unit) {
  return h("tr", { class: "parting" }, h("td", { colspan: 5 }, `Earlier life, before the replacement at ${amount(lifeStart)} ${unitName(unit)}`));
}

function historyRow(item, earlier) {
  const cell = (fault) => h("td", {}, item[fault.value] === null ? "–" : [
    faultValue(fault, item[fault.value], false), item[fault.std] !== null && h("span", { class: "pm" }, ` ± ${faultSpread(fault, item[fault.std], false)}`),
  ]);
  return h("tr", { class: earlier ? "earlier" : null, "data-verdict": item.verdict },
    h("td", { class: "time" }, h("a", { href: `/v1/traces/${encodeURIComponent(item.trace_id)}` }, when(item.recorded_at))),
    h("td", {}, fixed(item.usage, 1)),
    Object.values(FAULTS).map(cell),
    h("td", { class: "verdict" }, item.verdict));
}

function maintenanceList(record, maintenance) {
  return h("section", { class: "block" },
    h("h3", {}, "Maintenance"),
    maintenance.length === 0 && h("p", { class: "hint" }, "None recorded."),
    h("ul", { class: "events" }, maintenance.toReversed().map((event) => h("li", {},
      h("b", {}, event.kind), h("span", {}, `at ${amount(event.usage)} ${unitName(record.usage_unit)}, ${when(event.at)}`), event.note && h("p", {}, event.note)))));
}

function facts(record, life) {
  const path = `/v1/actuators/${encodeURIComponent(record.id)}`;
  const pair = (name, value) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
  const raw = { actuator: path, health: `${path}/health?limit=500`, "remaining life": `${path}/remaining-life`, baseline: `${path}/baseline`, maintenance: `${path}/maintenance` };
  const models = life.forecast?.models ?? [];
  return h("section", { class: "block" },
    h("h3", {}, "Particulars"),
    h("dl", { class: "facts" },
      Object.values(FAULTS).map((fault) => pair(`${fault.symbol} threshold`, faultLimit(fault, record.thresholds[fault.value]))),
      pair("Parameter set", record.parameter_set), pair("Registered", when(record.created_at)),
      models.length > 0 && pair("Forecast models", models.join(", ")),
      life.forecast && pair("Beyond the horizon", `${percent(life.forecast.probability_beyond_horizon)} after ${amount(life.forecast.horizon)} ${unitName(record.usage_unit)}`),
      pair("Identifier", h("code", {}, record.id))),
    h("p", { class: "raw" }, "Raw JSON ", Object.entries(raw).map(([name, href]) => h("a", { href }, name))));
}
