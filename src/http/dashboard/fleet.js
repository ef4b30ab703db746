/** The fleet ranked by risk: columns, rows, filters and the empty state. */

import { byId, h, reconcile, refill } from "./dom.js";
import { FAULTS, OVER, amount, counted, faultLimit, faultSpread, faultValue, interval90, median, percent, unitName, unitSymbol } from "./format.js";
import { gauge, lifeAxis, lifeRange, lifeScale } from "./gauges.js";
import { STATUSES, statusOf } from "./status.js";

const SEARCH_ABOVE = 10;
const ROWS_AT_ONCE = 100;

/** A status word with its mark. */
export function badge(status) {
  return h("span", { class: "badge", "data-status": status, title: `${STATUSES[status].word}: ${STATUSES[status].rule}` }, STATUSES[status].word);
}

const linkTo = (id) => `#/actuators/${encodeURIComponent(id)}`;

/** Draws the list. `view` holds `rows`, `filter {tail, text, statuses}`, `shown`, `selected`; `act` its callbacks. */
export function drawFleet(view, act) {
  const { rows, filter } = view;
  byId("tools").hidden = rows.length === 0;
  byId("columns").hidden = rows.length === 0;
  byId("legend").hidden = rows.length === 0;
  refill(byId("legend"), "words", legend);
  drawTally(rows, filter, act);
  drawTails(rows, filter);
  byId("text-field").hidden = rows.length <= SEARCH_ABOVE;

  const scale = lifeScale(rows);
  const heads = {
    scale,
    unit: shared(rows, (row) => unitSymbol(row.usage_unit)),
    window: shared(rows.filter((row) => row.risk), (row) => row.risk.within),
    limits: Object.values(FAULTS).map((fault) => shared(rows, (row) => faultLimit(fault, row.thresholds[fault.value], false))),
  };
  refill(byId("columns"), heads, () => columns(heads));
  byId("rows").classList.toggle("own-limits", heads.limits.includes(null));

  const matching = rows.filter((row) => matches(row, filter));
  const visible = matching.slice(0, view.shown);
  reconcile(byId("rows"), visible.map((row) => ({ key: row.actuator_id, data: [row, scale], draw: () => rowOf(row, scale) })));
  for (const link of byId("rows").querySelectorAll(".row")) {
    if (link.dataset.focus === view.selected) link.setAttribute("aria-current", "true");
    else link.removeAttribute("aria-current");
  }
  refill(byId("fleet-end"), [rows.length, matching.length, visible.length, view.truncated], () => fleetEnd(rows, matching, visible, view, act));
}

function matches(row, { tail, text, statuses }) {
  const words = [row.serial_number, row.tail_number, row.location, row.actuator_id].join(" ").toLowerCase();
  return (!tail || row.tail_number === tail)
    && (statuses.size === 0 || statuses.has(statusOf(row)))
    && text.toLowerCase().split(/\s+/).every((word) => words.includes(word));
}

/** What every row has in common, or null. */
function shared(rows, read) {
  const values = new Set(rows.map(read));
  return values.size === 1 ? [...values][0] : null;
}

function columns({ scale, unit, window, limits }) {
  const limit = (index) => (limits[index] === null ? "against threshold" : `threshold ${limits[index]}`);
  const head = (text, detail) => h("span", {}, text, detail && h("small", {}, detail));
  return [
    head("#"),
    head("Actuator", "aircraft, place"),
    head(FAULTS.kgm.axis, limit(0)),
    head(FAULTS.fdj_n.axis, limit(1)),
    h("span", { class: "head-life" }, `Remaining life${unit ? ` [${unit}]` : ""}`, lifeAxis(scale)),
    head("Risk", window === null ? "in window" : `next ${amount(window)}`),
    head("Status"),
  ];
}

function rowOf(row, scale) {
  const status = statusOf(row);
  return h("li", {},
    h("a", { class: "row", href: linkTo(row.actuator_id), "data-status": status, "data-focus": row.actuator_id, "aria-label": spoken(row, status) },
      h("span", { class: "rank" }, String(row.risk_rank)),
      h("span", { class: "who" }, h("b", {}, row.serial_number), h("span", {}, row.tail_number), h("small", {}, row.location)),
      Object.values(FAULTS).map((fault) => measure(row, fault)),
      lifeCell(row, scale),
      h("span", { class: "risk" }, row.risk ? percent(row.risk.probability) : "–", row.risk && h("small", {}, ` in ${amount(row.risk.within)} ${unitName(row.usage_unit)}`)),
      h("span", { class: "status" }, badge(status), row.alerts_open > 0 && h("span", { class: "flag" }, counted(row.alerts_open, "alert")))));
}

function measure({ newest, thresholds }, fault) {
  const value = newest?.[fault.value] ?? null;
  const std = newest?.[fault.std] ?? null;
  const figure = value === null
    ? h("span", { class: "none" }, newest ? "inconclusive" : "no record")
    : [h("b", {}, faultValue(fault, value, false)), std !== null && h("span", { class: "pm" }, `±${faultSpread(fault, std, false)}`)];
  return h("span", { class: "measure" },
    h("span", { class: "figure" }, h("span", { class: "tag" }, fault.axis), figure, h("span", { class: "of" }, faultLimit(fault, thresholds[fault.value], false))),
    gauge(value, std, thresholds[fault.value]));
}

function lifeCell(row, scale) {
  const life = row.remaining_life;
  if (!life) return h("span", { class: "life-cell none" }, row.reasons.join("; ") || "no forecast");
  const text = life.reached ? h("b", { class: "reached" }, "Past its threshold")
    : [h("b", {}, median(life, OVER)), h("span", { class: "unit" }, ` ${unitName(row.usage_unit)}`), life.quantiles["0.05"] !== null && h("span", { class: "pm" }, interval90(life, OVER))];
  return h("span", { class: "life-cell" }, h("span", { class: "figure" }, text), lifeRange(life.reached ? null : life, scale), lifeAxis(scale));
}

/** The row as one sentence, for those who hear it. */
function spoken(row, status) {
  const unit = unitName(row.usage_unit);
  const life = row.remaining_life;
  const values = Object.values(FAULTS).map((fault) => {
    const value = row.newest?.[fault.value] ?? null;
    return `${fault.symbol} ${value === null ? "not known" : faultValue(fault, value)}, threshold ${faultLimit(fault, row.thresholds[fault.value])}.`;
  });
  return [
    `Rank ${row.risk_rank}: ${row.serial_number} on ${row.tail_number}, ${row.location}. ${STATUSES[status].word}.`,
    life && (life.reached ? "Past its threshold." : `Median remaining life ${median(life)} ${unit}, 90 % interval ${interval90(life)}.`),
    row.risk && `${percent(row.risk.probability)} likely to pass within ${amount(row.risk.within)} ${unit}.`,
    ...values,
    row.alerts_open > 0 && `${counted(row.alerts_open, "alert")} not cleared.`,
  ].filter(Boolean).join(" ");
}

function drawTally(rows, filter, act) {
  const counts = Object.keys(STATUSES).map((status) => [status, rows.filter((row) => statusOf(row) === status).length]);
  refill(byId("tally"), [counts, [...filter.statuses]], () => [
    counts.map(([status, count]) => h("button", {
      type: "button", class: "chip", "data-status": status, "data-focus": status, title: STATUSES[status].rule,
      "aria-pressed": String(filter.statuses.has(status)), onclick: () => act.toggleStatus(status),
    }, STATUSES[status].word, h("b", {}, String(count)))),
  ]);
}

function drawTails(rows, filter) {
  const tails = [...new Set(rows.map((row) => row.tail_number))].sort();
  byId("tail-field").hidden = tails.length < 2;
  refill(byId("tail"), tails, () => [h("option", { value: "" }, "All aircraft"), ...tails.map((tail) => h("option", { value: tail }, tail))]);
  byId("tail").value = tails.includes(filter.tail) ? filter.tail : "";
}

function fleetEnd(rows, matching, visible, view, act) {
  if (rows.length === 0) return emptyFleet();
  const left = matching.length - visible.length;
  const more = left > ROWS_AT_ONCE ? `Show ${ROWS_AT_ONCE} more of ${left}` : `Show the other ${left}`;
  return [
    matching.length === 0 && h("p", { class: "hint" }, "No actuator matches. ", h("button", { type: "button", class: "quiet", onclick: act.clearFilter }, "Show all")),
    left > 0 && h("button", { type: "button", class: "quiet wide", "data-focus": "more", onclick: () => act.showMore(ROWS_AT_ONCE) }, more),
    view.truncated && h("p", { class: "hint" }, `Only the first ${counted(rows.length, "actuator")} by risk are shown.`),
  ].filter(Boolean);
}

function legend() {
  return [
    h("summary", {}, "What the words mean"),
    h("dl", {}, Object.values(STATUSES).map(({ word, rule }) => h("div", {}, h("dt", {}, word), h("dd", {}, rule)))),
    h("p", {}, "The window is the usage that a risk looks ahead. A bar shows a value with one standard deviation to each side, and its threshold as a mark."),
    h("p", {}, "Remaining life is on a logarithmic scale: 90 % interval thin, 50 % thick, median a dot, the window dashed."),
  ];
}

function emptyFleet() {
  return h("div", { class: "empty" },
    h("h2", {}, "Register the first one"),
    h("p", {}, "Then upload a trace of each flight: its health and remaining life appear here by themselves."),
    command(`curl -X POST ${location.origin}/v1/actuators \\\n  -H 'Content-Type: application/json' \\\n  -d '{"serial_number": "EHSA-0001", "tail_number": "I-ELVN",\n       "location": "left inboard elevon"}'`));
}

/** A shell command with a button that copies it. */
export function command(text) {
  const button = h("button", { type: "button", class: "quiet" }, "Copy");
  button.addEventListener("click", () => navigator.clipboard?.writeText(text).then(() => { button.textContent = "Copied"; }));
  return h("div", { class: "command" }, h("pre", { tabindex: 0 }, h("code", {}, text)), button);
}

/** Up and down move between the rows. */
export function onRowKey(event) {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  const links = [...byId("rows").querySelectorAll(".row")];
  const next = links[links.indexOf(document.activeElement) + step];
  if (!step || !next) return;
  event.preventDefault();
  next.focus();
}
