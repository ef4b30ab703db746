/** One actuator: the answer, the charts, the history, maintenance, and where the figures come from. */

import { badge, command } from "./fleet.js";
import { h, reconcile } from "./dom.js";
import { figureOf } from "./figure.js";
import { FAULTS, amount, faultLimit, faultValue, interval90, percent, quantile, unitName, when } from "./format.js";
import { statusOf } from "./status.js";
import { lifeStrip } from "./strip.js";

const HISTORY_AT_FIRST = 12;
const HISTORY_MORE = 50;

/** Draws `detail {record, history, life, maintenance, truncated}` into a container; `open` is how many records its table shows. */
export function drawActuator(container, detail, open, showMore) {
  const { record, history, life, maintenance } = detail;
  const replaced = maintenance.filter((event) => event.kind === "replaced").map((event) => event.usage);
  const lifeStart = Math.max(-Infinity, ...replaced);
  const shown = open || HISTORY_AT_FIRST;
  reconcile(container, [
    { key: "head", data: [record, life], draw: () => head(record, life) },
    ...(history.length === 0 ? [{ key: "none", data: record.id, draw: () => noRecords(record) }] : []),
    ...(history.length === 0 ? [] : Object.values(FAULTS)).map((fault) => {
      const model = modelOf(fault, detail, lifeStart);
      return { key: fault.value, data: model, draw: () => figureOf(model) };
    }),
    ...(history.length === 0 ? [] : [{ key: "history", data: [history, shown, lifeStart], draw: () => historyTable(detail, shown, lifeStart, showMore) }]),
    { key: "maintenance", data: maintenance, draw: () => maintenanceList(record, maintenance) },
    { key: "facts", data: [record, life], draw: () => facts(record, life) },
  ]);
}

function modelOf(fault, { record, history, life, maintenance }, lifeStart) {
  const forecast = life.faults[fault.value];
  return {
    fault,
    unit: unitName(record.usage_unit),
    limit: forecast.threshold,
    now: life.usage ?? history.at(-1).usage,
    points: history.map((item) => ({
      usage: item.usage, value: item[fault.value], std: item[fault.std], recorded_at: item.recorded_at, earlier: item.usage < lifeStart,
    })),
    band: forecast.band ?? [],
    forecast: forecast.forecast,
    reasons: forecast.reasons,
    events: maintenance.map(({ kind, usage }) => ({ kind, usage })),
  };
}

/** The fault whose threshold is likely to be passed first. */
function limiting(life) {
  const rank = ({ forecast, risk }) => [forecast.reached ? 0 : 1, -(risk?.probability ?? 0), forecast.quantiles["0.5"] ?? Infinity, forecast.quantiles["0.05"] ?? Infinity];
  const known = Object.values(FAULTS).filter((fault) => life.faults[fault.value].forecast);
  return known.toSorted((a, b) => {
    const [left, right] = [a, b].map((fault) => rank(life.faults[fault.value]));
    const differing = left.findIndex((value, index) => value !== right[index]);
    return differing < 0 ? 0 : left[differing] - right[differing];
  })[0];
}

function head(record, life) {
  const status = statusOf({ remaining_life: life.forecast, risk: life.risk });
  return h("header", { class: "detail-head" },
    h("a", { class: "back", href: "#/" }, "Fleet"),
    h("p", { class: "identity" }, h("b", {}, record.serial_number), h("span", {}, record.tail_number), h("span", {}, record.location), badge(status)),
    ...headline(life, unitName(record.usage_unit)),
    life.forecast && !life.forecast.reached && lifeStrip(life.forecast, life.risk, unitName(record.usage_unit)));
}

function headline(life, unit) {
  const { forecast, risk } = life;
  if (!forecast) return [h("h2", {}, "No forecast yet"), h("p", { class: "because" }, life.reasons.join("; ") || "There are too few conclusive records.")];
  const fault = limiting(life);
  const limit = fault && `Limiting fault: ${fault.name} (${fault.symbol}).`;
  const chance = risk && `${percent(risk.probability)} likely to pass within ${amount(risk.within)} ${unit}.`;
  const asOf = `As of ${amount(life.usage)} ${unit}${life.as_of ? `, ${when(life.as_of)}` : ""}.`;
  if (forecast.reached) {
    const passed = Object.values(FAULTS).filter(({ value }) => life.faults[value].forecast?.reached);
    return [
      h("h2", { class: "past" }, "Past its threshold"),
      h("p", { class: "because" }, `${passed.length > 0 ? `${passed.map(({ name, symbol }) => `${name} (${symbol})`).join(" and ")} reached the threshold. ` : ""}${asOf}`),
    ];
  }
  return [
    h("h2", {}, h("small", {}, "Median remaining life"), " ", h("b", {}, quantile(forecast.quantiles["0.5"], forecast.horizon)), ` ${unit} `, h("span", { class: "interval" }, `(90 %: ${interval90(forecast)})`)),
    h("p", { class: "because" }, [limit, chance, asOf].filter(Boolean).join(" ")),
    life.reasons.length > 0 && h("p", { class: "because" }, life.reasons.join("; ")),
  ].filter(Boolean);
}

function noRecords(record) {
  return h("div", { class: "empty" },
    h("h3", {}, "No record yet"),
    h("p", {}, "Upload the first trace; its estimate follows by itself."),
    command(`curl -X POST '${location.origin}/v1/actuators/${record.id}/traces?recorded_at=${new Date().toISOString().slice(0, 10)}T00:00:00Z&usage=10' \\\n  -H 'Content-Type: text/csv' --data-binary @trace.csv`));
}

function historyTable({ record, history, truncated }, shown, lifeStart, showMore) {
  const newestFirst = history.toReversed();
  const left = newestFirst.length - shown;
  const cell = (item, { value, std }, fault) => h("td", {}, item[value] === null ? "–" : [faultValue(fault, item[value], false), item[std] !== null && h("span", { class: "pm" }, ` ± ${faultValue(fault, item[std], false)}`)]);
  return h("section", { class: "block" },
    h("h3", {}, "History"),
    h("div", { class: "scroller", tabindex: 0, role: "region", "aria-label": "History table" }, h("table", {},
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Recorded"), h("th", { scope: "col" }, `Usage [${unitName(record.usage_unit)}]`), h("th", { scope: "col" }, "KGM [-]"), h("th", { scope: "col" }, "FDJ [N]"), h("th", { scope: "col" }, "Verdict"))),
      h("tbody", {}, newestFirst.slice(0, shown).map((item) => h("tr", { class: item.usage < lifeStart ? "earlier" : null },
        h("td", {}, h("a", { href: `/v1/traces/${encodeURIComponent(item.trace_id)}` }, when(item.recorded_at))),
        h("td", {}, item.usage.toFixed(1)),
        Object.values(FAULTS).map((fault) => cell(item, fault, fault)),
        h("td", { class: item.verdict }, item.usage < lifeStart ? `${item.verdict}, earlier life` : item.verdict)))))),
    left > 0 && h("button", { type: "button", class: "quiet wide", "data-focus": "more-history", onclick: () => showMore(shown + HISTORY_MORE) }, `Show ${Math.min(left, HISTORY_MORE)} more of ${left}`),
    truncated && h("p", { class: "hint" }, "Older records are not all shown; the raw JSON has them."));
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
  const raw = { actuator: path, health: `${path}/health?limit=500`, "remaining life": `${path}/remaining-life`, maintenance: `${path}/maintenance` };
  const models = life.forecast?.models ?? [];
  return h("section", { class: "block" },
    h("h3", {}, "Particulars"),
    h("dl", { class: "facts" },
      Object.values(FAULTS).map((fault) => pair(`${fault.symbol} threshold`, faultLimit(fault, record.thresholds[fault.value]))),
      pair("Parameter set", record.parameter_set), pair("Registered", when(record.created_at)),
      models.length > 0 && pair("Forecast models", models.join(", ")),
      pair("Identifier", h("code", {}, record.id))),
    h("p", { class: "raw" }, "Raw JSON ", Object.entries(raw).map(([name, href]) => h("a", { href }, name))));
}
