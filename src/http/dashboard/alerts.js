/** Alerts: those of the fleet that are not cleared, and all of one actuator, each with what became of it. */

import { h } from "./dom.js";
import { amount, counted, sentence, unitName, when } from "./format.js";

const AT_FIRST = 4;
const CLEARED_AT_FIRST = 3;
const NOTE_CHARS_MAX = 2000;
const WORDS = { open: "Open", acknowledged: "Acknowledged", cleared: "Cleared" };
const BECAUSE = { level_fell: "the level fell well below its threshold", risk_fell: "the risk fell", maintenance: "maintenance began a new life" };

const state = (alert) => h("b", { class: "alert-state" }, WORDS[alert.state] ?? alert.state);

/** What an alert says, without the actuator's name, which stands beside it. */
function words({ message, tail_number: tail }) {
  const name = ` of ${tail}: `;
  const at = message.indexOf(name);
  return sentence(at < 0 ? message : message.slice(at + name.length));
}

/** `1 open alert, 1 acknowledged`, or nothing. */
export function tally(alerts) {
  const open = alerts.filter((alert) => alert.state === "open").length;
  const known = alerts.length - open;
  return [open && counted(open, "open alert"), known && (open ? `${known} acknowledged` : counted(known, "acknowledged alert"))].filter(Boolean).join(", ");
}

/** The fleet's alerts that are not cleared, newest first: `{items, truncated, problem}`. */
export function fleetAlerts({ items, truncated, problem }, all, showAll) {
  if (problem) return [h("p", { class: "failure", role: "alert" }, `The alerts could not be read. ${problem.title}: ${problem.detail}`)];
  if (items.length === 0) return [h("p", { class: "hint" }, "No alert is open.")];
  const left = items.length - AT_FIRST;
  return [
    h("h2", {}, tally(items)),
    h("ul", {}, items.slice(0, all ? items.length : AT_FIRST).map((alert) => h("li", {},
      h("a", { class: "alert-link", href: `#/actuators/${encodeURIComponent(alert.actuator_id)}`, "data-state": alert.state, "data-focus": `alert-${alert.id}` },
        h("span", { class: "alert-head" }, state(alert), h("b", {}, alert.serial_number), h("span", {}, alert.tail_number), h("span", { class: "hint" }, `since ${when(alert.raised_at)}`)),
        h("span", { class: "alert-words" }, words(alert)))))),
    left > 0 && !all && h("button", { type: "button", class: "quiet wide", "data-focus": "more-alerts", onclick: showAll }, `Show the other ${left}`),
    truncated && h("p", { class: "hint" }, "Only the newest alerts are shown."),
  ].filter(Boolean);
}

/**
 * The alerts of an actuator as entries of `reconcile`, so that a note that is being written outlives a poll. `answers` holds, by
 * alert, `{note, pending, problem}` of an acknowledgement.
 */
export function alertEntries({ items, truncated, problem }, answers, acknowledge) {
  const cleared = items.filter((alert) => alert.state === "cleared");
  const current = items.filter((alert) => alert.state !== "cleared");
  const title = tally(current) || "No open alert";
  const entry = (alert) => {
    const answer = answers.get(alert.id) ?? null;
    return { key: `alert-${alert.id}`, data: [alert, answer], draw: () => article(alert, answer, acknowledge) };
  };
  return [
    { key: "alerts", data: [title, items.length, problem?.detail ?? null], draw: () => heading(title, items.length, problem) },
    ...current.map(entry),
    ...cleared.slice(0, CLEARED_AT_FIRST).map(entry),
    ...(cleared.length > CLEARED_AT_FIRST || truncated ? [{ key: "alerts-rest", data: [cleared, truncated], draw: () => rest(cleared.slice(CLEARED_AT_FIRST), truncated) }] : []),
  ];
}

function heading(title, count, problem) {
  return h("div", { class: "block" },
    h("h3", {}, problem ? "Alerts" : title),
    count === 0 && !problem && h("p", { class: "hint" }, "None has been raised so far."),
    problem && h("p", { class: "failure", role: "alert" }, `The alerts could not be read. ${problem.title}: ${problem.detail}`));
}

function article(alert, answer, acknowledge) {
  const { acknowledged_at: acknowledged, cleared_at: cleared } = alert;
  return h("article", { class: "alert", "data-state": alert.state, tabindex: -1, "data-focus": `acknowledge-${alert.id}-done` },
    h("p", { class: "alert-head" }, state(alert), h("span", {}, `${cleared ? "raised" : "since"} ${when(alert.raised_at)}`), h("span", {}, `at ${amount(alert.usage)} ${unitName(alert.usage_unit)}`)),
    h("p", {}, words(alert)),
    acknowledged && h("p", { class: "became" }, `Acknowledged ${when(acknowledged)}${alert.note ? `: ${alert.note}` : "."}`),
    cleared && h("p", { class: "became" }, `Cleared ${when(cleared)}: ${BECAUSE[alert.cleared_because] ?? alert.cleared_because}.`),
    alert.state === "open" && answering(alert, answer, acknowledge));
}

function answering(alert, answer, acknowledge) {
  const note = h("input", { name: "note", maxlength: NOTE_CHARS_MAX, autocomplete: "off", placeholder: "Note (optional)", value: answer?.note ?? "", "data-focus": `note-${alert.id}` });
  const send = (event) => {
    event.preventDefault();
    if (!answer?.pending) acknowledge(alert.id, note.value.trim());
  };
  return h("form", { class: "answering field", onsubmit: send },
    h("label", {}, h("span", { class: "unseen" }, "Note on the acknowledgement"), note),
    h("button", { type: "submit", class: "quiet", "aria-disabled": answer?.pending && "true", "data-focus": `acknowledge-${alert.id}` }, answer?.pending ? "Acknowledging…" : "Acknowledge"),
    answer?.problem && h("p", { class: "failure", role: "alert" }, `Not acknowledged. ${answer.problem.title}: ${answer.problem.detail}`));
}

function rest(cleared, truncated) {
  return h("details", { class: "figures" },
    h("summary", {}, `${cleared.length}${truncated ? " or more" : ""} earlier`),
    h("ul", { class: "events" }, cleared.map((alert) => h("li", {},
      h("span", {}, `${when(alert.raised_at)} to ${when(alert.cleared_at)}`), h("p", {}, words(alert))))));
}
