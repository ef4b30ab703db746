/** The answer for one actuator, before any plot: its state, its remaining life, and when to act. */

import { badge } from "./fleet.js";
import { h } from "./dom.js";
import { FAULTS, amount, day, faultGrowth, faultLimit, faultValue, fixed, interval90, median, percent, sentence, unitName, when } from "./format.js";
import { statusOf } from "./status.js";
import { lifeStrip } from "./strip.js";

const DATED = [["0.05", "5 % quantile"], ["0.5", "Median"], ["0.95", "95 % quantile"]];

/** The way back to the list, where the list is not beside the actuator. */
export function back() {
  return h("a", { class: "back", href: "#/" }, "Fleet");
}

/**
 * The faults in the order in which their thresholds are likely to be passed: the limiting one first. As in the fleet's
 * order, risks are compared in whole percents.
 */
export function byUrgency(life) {
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

/** The head of an actuator's page. */
export function head(record, life, history, lifeStart) {
  const status = statusOf({ remaining_life: life.forecast, risk: life.risk });
  const unit = unitName(record.usage_unit);
  const grown = sinceNew(history, lifeStart);
  return h("header", { class: "detail-head" },
    back(),
    h("p", { class: "identity" }, h("b", {}, record.serial_number), h("span", {}, record.tail_number), h("span", {}, record.location), badge(status)),
    headline(life, unit),
    life.act_by && actBy(life, unit),
    life.forecast && because(life, history, unit),
    grown && h("p", { class: "because" }, grown),
    life.forecast && !life.forecast.reached && [
      life.forecast.quantiles["0.05"] !== null && lifeStrip(life.forecast, life.risk, unit),
      dates(life, unit),
    ]);
}

function headline({ forecast, reasons, faults }, unit) {
  if (!forecast) return [h("h2", {}, "No forecast yet"), h("p", { class: "because" }, reasons.map(said).join(" ") || "There are too few conclusive records.")];
  if (forecast.reached) {
    const passed = Object.values(FAULTS).filter(({ value }) => faults[value].forecast?.reached);
    return h("h2", { class: "past" }, ["Past its threshold", passed.map(({ name }) => name).join(" and ")].filter(Boolean).join(": "));
  }
  return h("h2", {}, "Median remaining life ", h("span", { class: "together" }, `${median(forecast)} ${unit}`), " ",
    forecast.quantiles["0.05"] !== null && h("span", { class: "interval" }, `(90 %: ${interval90(forecast)})`));
}

/** When to act at the service's risk, or why that is not known. */
function actBy({ forecast, act_by: { risk, remaining, usage, date, reason } }, unit) {
  const odds = `a risk of ${fixed(100 * risk, 0, 2)} %`;
  const act = (...words) => h("p", { class: "act-by" }, words);
  if (forecast?.reached) return act(h("b", {}, "Act now"), ": the threshold is passed.");
  if (remaining === null) return act("No date by which to act", reason && `: ${reason}`, ".");
  if (remaining === 0) return act(h("b", {}, "Act now"), `: ${odds} is reached.`);
  const place = `${amount(usage)} ${unit}`;
  if (date === null) return act("Act by ", h("b", {}, place), ` for ${odds}`, reason && ` (${reason})`, ".");
  return act("Act by ", h("b", {}, day(date)), ` (at ${place}) for ${odds}.`);
}

function because(life, history, unit) {
  const { forecast, risk, faults, usage, as_of: recorded } = life;
  const asOf = `As of ${amount(usage)} ${unit}${recorded ? `, ${when(recorded)}` : ""}.`;
  if (forecast.reached) {
    const passed = Object.values(FAULTS).filter(({ value }) => faults[value].forecast?.reached);
    return h("p", { class: "because" }, [...passed.map((each) => measured(each, history, faults[each.value].threshold)), asOf].join(" "));
  }
  const [fault] = byUrgency(life);
  const limit = faults[fault.value].forecast && `Limiting fault: ${fault.name} (${fault.symbol}).`;
  const chance = risk && `${percent(risk.probability)} likely to pass within ${amount(risk.within)} ${unit}.`;
  return [h("p", { class: "because" }, [limit, chance, asOf].filter(Boolean).join(" ")), ownReasons(life).map((reason) => h("p", { class: "noted" }, said(reason)))];
}

/** A reason as a sentence, its fault by its symbol. */
const said = (reason) => sentence(reason.replace(/^(kgm|fdj_n)\b/, (name) => FAULTS[name].symbol));

/** The reasons that are the actuator's own: those of a fault stand at its plot. */
function ownReasons({ reasons, faults }) {
  const told = Object.entries(faults).filter(([, { forecast }]) => forecast).flatMap(([name, fault]) => fault.reasons.map((reason) => `${name}: ${reason}`));
  return reasons.filter((reason) => !told.includes(reason));
}

function measured(fault, history, limit) {
  const newest = history.findLast((item) => item[fault.value] !== null);
  return newest ? `${fault.symbol} ${faultValue(fault, newest[fault.value])} against ${faultLimit(fault, limit)}.` : "";
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

/** The dates and the usages that the quantiles mean, and the rate of use that they rest on. */
function dates({ forecast, use_rate: rate }, unit) {
  const cell = (name, value, more) => h("div", {}, h("dt", {}, name), h("dd", {}, value, more && h("small", {}, more)));
  const end = (level) => {
    const life = forecast.quantiles[level];
    if (life === null) return [`beyond ${amount(forecast.at + forecast.horizon)}`, unit];
    const place = `${amount(forecast.at + life)} ${unit}`;
    return forecast.dates[level] ? [day(forecast.dates[level]), `at ${place}`] : [place, "no date"];
  };
  const use = rate.per_day === null ? ["unknown", rate.reason] : [`${amount(rate.per_day)} a day`, `${unit}, recent rate`];
  return h("dl", { class: "dates" }, DATED.map(([level, name]) => cell(name, ...end(level))), cell("Rate of use", ...use));
}
