/** The remaining life of one actuator as a scale from now on. */

import { h, s } from "./dom.js";
import { fixed } from "./format.js";
import { ticks } from "./plot.js";

/** A linear scale with the 90 % and 50 % intervals, the median and the risk window. */
export function lifeStrip({ quantiles, horizon }, risk, unit) {
  const end = Math.max((quantiles["0.95"] ?? horizon) * 1.06, (risk?.within ?? 0) * 1.15);
  const share = (life) => `${((Math.min(life ?? end, end) / end) * 100).toFixed(2)}%`;
  const scale = ticks(0, end, 5);
  const at = (level) => share(quantiles[level]);
  const label = (value) => (value === 0 ? "start" : value / end > 0.94 ? "end" : "middle");
  return h("div", { class: "strip", "aria-hidden": "true" }, s("svg", {},
    risk && s("rect", { class: "window", x: 0, y: 0, width: share(risk.within), height: 26 }),
    risk && s("line", { class: "window-edge", x1: share(risk.within), x2: share(risk.within), y1: 0, y2: 26 }),
    s("line", { class: "base", x1: 0, x2: "100%", y1: 26, y2: 26 }),
    scale.values.map((value) => s("line", { class: "tick", x1: share(value), x2: share(value), y1: 26, y2: 30 })),
    scale.values.map((value) => s("text", { x: share(value), y: 42, "text-anchor": label(value) }, fixed(value, scale.decimals))),
    s("line", { class: "range90", x1: at("0.05"), x2: at("0.95"), y1: 13, y2: 13 }),
    s("line", { class: "range50", x1: at("0.25"), x2: at("0.75"), y1: 13, y2: 13 }),
    quantiles["0.5"] !== null && s("line", { class: "median", x1: at("0.5"), x2: at("0.5"), y1: 3, y2: 23 })),
  h("p", {}, `${unit} from now; bar 50 %, line 90 %, mark median${risk ? `; shaded: the next ${fixed(risk.within, 0)}` : ""}`));
}
