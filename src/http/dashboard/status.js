/** The status words, and the fleet in one sentence. */

import { counted, unitName } from "./format.js";

const LIKELY = 0.5;
const POSSIBLE = 0.1;
const WINDOWS_AHEAD = 3;

/** The words in order of urgency, each with the rule that the legend shows. */
export const STATUSES = {
  act: { word: "Act now", rule: "past its threshold, or at least 50 % likely to pass within the window" },
  plan: { word: "Plan", rule: "at least 10 % likely to pass within the window, or a median remaining life of three windows or less" },
  watch: { word: "Watch", rule: "at least a 5 % chance to pass within three windows" },
  healthy: { word: "Healthy", rule: "none of the above" },
  unknown: { word: "Unknown", rule: "no forecast: too few conclusive records" },
};

/** The key in `STATUSES` of a fleet row, from its risk and its remaining-life quantiles. */
export function statusOf({ remaining_life: life, risk }) {
  if (!life) return "unknown";
  if (life.reached) return "act";
  if (!risk) return "unknown";
  const ahead = WINDOWS_AHEAD * risk.within;
  const within = (level) => life.quantiles[level] !== null && life.quantiles[level] <= ahead;
  if (risk.probability >= LIKELY) return "act";
  if (risk.probability >= POSSIBLE || within("0.5")) return "plan";
  return within("0.05") ? "watch" : "healthy";
}

/** The risk windows in words: `100 flight hours`. */
function windowsOf(rows) {
  const windows = new Set(rows.filter((row) => row.risk).map((row) => `${row.risk.within} ${unitName(row.usage_unit)}`));
  return [...windows].join(" or ") || "the risk window";
}

/** The summary as pieces `{text, tone}`: the counts that ask for action carry a tone. */
export function summary(rows) {
  const past = rows.filter((row) => row.remaining_life?.reached).length;
  const likely = rows.filter((row) => !row.remaining_life?.reached && row.risk?.probability >= LIKELY).length;
  const unknown = rows.filter((row) => statusOf(row) === "unknown").length;
  const aircraft = new Set(rows.map((row) => row.tail_number)).size;
  if (rows.length === 0) return [{ text: "No actuator is registered yet" }];
  return [
    { text: `${counted(rows.length, "actuator")} on ${counted(aircraft, "aircraft", "aircraft")}; ` },
    { text: `${past || "none"} past ${past > 1 ? "their" : "its"} threshold`, tone: past ? "act" : null },
    { text: ", " },
    { text: `${likely || "none"} likely to pass within ${windowsOf(rows)}`, tone: likely ? "act" : null },
    { text: unknown ? `; ${unknown} without a forecast.` : "." },
  ];
}
