/** Numbers, times and words as the page writes them. */

const NBSP = "\u00a0";

/** `beyond` where room is short. */
export const OVER = `>${NBSP}`;

const FORMATS = new Map();

/** The two faults that are watched: JSON names, symbols, words, units and decimals. */
export const FAULTS = {
  kgm: { value: "kgm", std: "kgm_std", symbol: "KGM", name: "demagnetisation", unit: "", axis: "KGM [-]", decimals: 3, limitDecimals: [2, 4] },
  fdj_n: { value: "fdj_n", std: "fdj_n_std", symbol: "FDJ", name: "jack friction", unit: "N", axis: "FDJ [N]", decimals: 0, limitDecimals: [0, 2] },
};

/** A number with grouped thousands and `least` to `most` decimals. */
export function fixed(value, least, most = least) {
  const name = `${least} ${most}`;
  if (!FORMATS.has(name)) {
    FORMATS.set(name, new Intl.NumberFormat("en-GB", { minimumFractionDigits: least, maximumFractionDigits: most }));
  }
  return FORMATS.get(name).format(value);
}

/** A usage or a remaining life: one decimal below ten, whole numbers above. */
export function amount(value) {
  return fixed(value, value < 9.95 && value > 0 ? 1 : 0);
}

/** The median remaining life, with the same `beyond`. */
export function median({ quantiles, horizon }, beyond = "beyond ") {
  return quantiles["0.5"] === null ? `${beyond}${amount(horizon)}` : amount(quantiles["0.5"]);
}

/** The 90 % interval; `beyond` is how it says that a bound lies beyond the horizon. */
export function interval90({ quantiles, horizon }, beyond = "beyond ") {
  const [low, high] = [quantiles["0.05"], quantiles["0.95"]];
  if (low === null) return `${beyond}${amount(horizon)}`;
  return `${amount(low)} to ${high === null ? beyond : ""}${amount(high ?? horizon)}`;
}

/** A probability as a percentage that never claims certainty. */
export function percent(probability) {
  if (probability < 0.005) return `<${NBSP}1${NBSP}%`;
  if (probability > 0.995) return `>${NBSP}99${NBSP}%`;
  return `${Math.round(probability * 100)}${NBSP}%`;
}

/** A fault's value with its unit, or its decimals alone. */
export function faultValue(fault, value, withUnit = true) {
  return fixed(value, fault.decimals) + (withUnit && fault.unit ? NBSP + fault.unit : "");
}

/** A fault's standard deviation, its unit where it is asked for, and never as nothing. */
export function faultSpread(fault, std, withUnit = true) {
  const least = 10 ** -fault.decimals;
  return std < 0.5 * least ? `<${faultValue(fault, least, withUnit)}` : faultValue(fault, std, withUnit);
}

/** How much a fault has grown, with its sign, its standard deviation where there is one, and its unit. */
export function faultGrowth(fault, value, std) {
  const sign = value < 0 ? "\u2212" : "+";
  const doubt = std === null ? "" : ` ± ${faultSpread(fault, std, false)}`;
  return sign + fixed(Math.abs(value), fault.decimals) + doubt + (fault.unit ? NBSP + fault.unit : "");
}

/** A fault's threshold with its unit. */
export function faultLimit(fault, value, withUnit = true) {
  return fixed(value, ...fault.limitDecimals) + (withUnit && fault.unit ? NBSP + fault.unit : "");
}

/** A text as a sentence: with a capital and a full stop. */
export function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");
}

/** `flight_hours` as `flight hours`. */
export function unitName(unit) {
  return unit.replaceAll("_", " ");
}

/** The usual abbreviation of a unit of usage, for the head of a column. */
export function unitSymbol(unit) {
  return { flight_hours: "FH", flight_cycles: "FC" }[unit] ?? unitName(unit);
}

/** A count with its noun: `1 actuator`, `8 actuators`. */
export function counted(count, one, many = `${one}s`) {
  return `${fixed(count, 0)} ${count === 1 ? one : many}`;
}

/** An RFC 3339 time as `2026-03-01 14:05 Z`. */
export function when(time) {
  const parsed = new Date(time);
  return Number.isNaN(parsed.getTime()) ? String(time) : `${parsed.toISOString().slice(0, 16).replace("T", " ")}${NBSP}Z`;
}

/** The day of an RFC 3339 time, `2026-03-01`. */
export function day(time) {
  return when(time).slice(0, 10);
}

/** The time of day of a `Date`, `14:05:09 Z`. */
export function clock(date) {
  return `${date.toISOString().slice(11, 19)}${NBSP}Z`;
}
