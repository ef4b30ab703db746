/** One actuator: the answer, the charts, the history, maintenance, and where the figures come from. */

import { alertEntries } from "./alerts.js";
import { byUrgency, head } from "./answer.js";
import { h, reconcile } from "./dom.js";
import { figureOf } from "./figure.js";
import { command } from "./fleet.js";
import { FAULTS, amount, counted, faultLimit, faultSpread, faultValue, fixed, percent, unitName, when } from "./format.js";
import { noTrend, trendFigure } from "./trend.js";

const HISTORY_AT_FIRST = 12;
const HISTORY_MORE = 50;

/**
 * Draws `detail {record, history, life, maintenance, trend, alerts, truncated}` into a container; `view` is `{open, answers}`: how many
 * records its table shows, and the acknowledgements under way; `act` its callbacks.
 */
export function drawActuator(container, detail, view, act) {
  const { record, history, life, maintenance, trend, alerts } = detail;
  const starts = maintenance.filter((event) => event.kind !== "inspected").map((event) => event.usage);
  const lifeStart = Math.max(-Infinity, ...starts);
  const shown = view.open || HISTORY_AT_FIRST;
  const told = alertEntries(alerts, view.answers, act.acknowledge);
  const urgent = alerts.problem !== null || alerts.items.some((alert) => alert.state !== "cleared");
  const some = history.length > 0;
  const trended = trend.items.length > 1;
  reconcile(container, [
    { key: "head", data: [record, life, history, lifeStart], draw: () => head(record, life, history, lifeStart) },
    ...(urgent ? told : []),
    ...(some ? byUrgency(life) : []).map((fault) => {
      const model = modelOf(fault, detail, lifeStart);
      return { key: fault.value, data: model, draw: () => figureOf(model) };
    }),
    ...(some && trended ? [{ key: "trend", data: [trend, maintenance], draw: () => trendFigure(trend.items, maintenance, record.usage_unit) }] : []),
    ...(some && !trended ? [{ key: "no-trend", data: trend.problem?.detail ?? null, draw: () => noTrend(trend.problem) }] : []),
    ...(some ? [] : [{ key: "none", data: record.id, draw: () => noRecords(record) }]),
    ...(urgent ? [] : told),
    ...(some ? [{ key: "history", data: [history, shown, lifeStart], draw: () => historyTable(detail, shown, lifeStart, act.showMoreHistory) }] : []),
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
    changes: forecast.changes,
    events: maintenance.map(({ kind, usage }) => ({ kind, usage })),
  };
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
    h("div", { class: "scroller", tabindex: 0, role: "region", "aria-label": "History table" }, h("table", { class: "records" },
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

/** The other lives that a fault's forecast is expected to be like. */
function learntFrom({ actuators, earlier_lives: earlier }) {
  const lives = [actuators > 0 && counted(actuators, "other actuator"), earlier > 0 && counted(earlier, "earlier life", "earlier lives")];
  return lives.filter(Boolean).join(", ") || "its own history alone";
}

function facts(record, life) {
  const path = `/v1/actuators/${encodeURIComponent(record.id)}`;
  const pair = (name, value) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
  const raw = { actuator: path, health: `${path}/health?limit=500`, "remaining life": `${path}/remaining-life`, trend: `${path}/remaining-life/trend?limit=500`, alerts: `${path}/alerts`, baseline: `${path}/baseline`, maintenance: `${path}/maintenance` };
  const models = life.forecast?.models ?? [];
  return h("section", { class: "block" },
    h("h3", {}, "Particulars"),
    h("dl", { class: "facts" },
      Object.values(FAULTS).map((fault) => pair(`${fault.symbol} threshold`, faultLimit(fault, record.thresholds[fault.value]))),
      pair("Parameter set", record.parameter_set), pair("Registered", when(record.created_at)),
      life.forecast && Object.values(FAULTS).map((fault) => pair(`${fault.symbol} learnt from`, learntFrom(life.faults[fault.value].learnt_from))),
      models.length > 0 && pair("Forecast models", models.join(", ")),
      life.forecast && pair("Beyond the horizon", `${percent(life.forecast.probability_beyond_horizon)} after ${amount(life.forecast.horizon)} ${unitName(record.usage_unit)}`),
      pair("Identifier", h("code", {}, record.id))),
    h("p", { class: "raw" }, "Raw JSON ", Object.entries(raw).map(([name, href]) => h("a", { href }, name))));
}
