/** The page's one owner of state: it polls, follows the address, and hands the state to the views. */

import { drawActuator } from "./actuator.js";
import { fleetAlerts, tally } from "./alerts.js";
import { back } from "./answer.js";
import { asProblem, get, getAll, patch, tryAll } from "./api.js";
import { byId, h, reconcile, refill } from "./dom.js";
import { drawFleet, onRowKey } from "./fleet.js";
import { clock, counted, percent } from "./format.js";
import { statusOf, summary } from "./status.js";

const POLL_MS = 5_000;
const POLL_MAX_MS = 60_000;
const DETAIL_MAX_AGE_MS = 30_000;
const ROWS_AT_FIRST = 100;
const FLEET_PAGES_MAX = 4;
const DESK = matchMedia("(min-width: 1360px)");

const state = {
  rows: null, truncated: false, alerts: null, allAlerts: false, jobs: null, updated: null, problem: null, failures: 0,
  filter: { tail: "", text: "", statuses: new Set() }, shown: ROWS_AT_FIRST,
  chosen: null, preview: null, detail: null, detailProblem: null, historyShown: 0, asked: {}, answers: new Map(),
};
let timer = null;
let polling = false;

const selected = () => state.chosen ?? (DESK.matches ? state.preview : null);

const act = {
  toggleStatus(status) {
    if (!state.filter.statuses.delete(status)) state.filter.statuses.add(status);
    render();
  },
  clearFilter() {
    state.filter = { tail: "", text: "", statuses: new Set() };
    byId("text").value = "";
    render();
  },
  showMore(count) {
    state.shown += count;
    render();
  },
  showMoreHistory(count) {
    state.historyShown = count;
    renderDetail();
  },
  async acknowledge(id, note) {
    const answer = (more) => {
      state.answers.set(id, { note, pending: false, problem: null, ...more });
      renderDetail();
    };
    answer({ pending: true });
    try {
      const now = await patch(`/v1/alerts/${encodeURIComponent(id)}`, { state: "acknowledged", note });
      const replaced = (list) => list && { ...list, items: list.items.map((alert) => (alert.id === id ? now : alert)) };
      state.alerts = replaced(state.alerts);
      if (state.detail) state.detail.alerts = replaced(state.detail.alerts);
      state.answers.delete(id);
      render();
      byId("told").textContent = `The alert of ${now.serial_number} is acknowledged.`;
      byId("detail").querySelector(`[data-focus="acknowledge-${CSS.escape(id)}-done"]`)?.focus({ preventScroll: true });
    } catch (error) {
      answer({ problem: asProblem(error) });
    }
    state.asked = {};
    refreshDetail();
  },
};

async function poll() {
  if (polling) return;
  polling = true;
  clearTimeout(timer);
  try {
    await readFleet();
    render();
    await refreshDetail();
  } finally {
    polling = false;
    if (!document.hidden) timer = setTimeout(poll, pause());
  }
}

async function readFleet() {
  try {
    const [fleet, running, queued, open, acknowledged] = await Promise.all([
      getAll("/v1/fleet/health?sort=risk&limit=500", FLEET_PAGES_MAX), get("/v1/jobs?state=running&limit=50"), get("/v1/jobs?state=queued&limit=50"),
      tryAll("/v1/alerts?state=open&limit=500", 1), tryAll("/v1/alerts?state=acknowledged&limit=500", 1),
    ]);
    Object.assign(state, { rows: fleet.items, truncated: fleet.truncated, alerts: together(open, acknowledged), jobs: { running, queued }, updated: new Date(), problem: null, failures: 0 });
    const listed = fleet.items.some((row) => row.actuator_id === state.preview);
    if (!listed) state.preview = fleet.items[0]?.actuator_id ?? null;
  } catch (error) {
    state.problem = asProblem(error);
    state.failures += 1;
  }
}

/** Two lists of alerts as one, newest first. */
function together(one, other) {
  const items = [...one.items, ...other.items].sort((a, b) => b.raised_at.localeCompare(a.raised_at));
  return { items, truncated: one.truncated || other.truncated, problem: one.problem ?? other.problem };
}

function pause() {
  const backedOff = Math.min(POLL_MS * 2 ** Math.max(state.failures - 1, 0), POLL_MAX_MS);
  return Math.max(backedOff, (state.problem?.retryAfterS ?? 0) * 1000);
}

/** Reads the selected actuator again when its fleet row changed, or after a while. */
async function refreshDetail() {
  const id = selected();
  if (id === null) return;
  const row = JSON.stringify(state.rows?.find((item) => item.actuator_id === id) ?? null);
  const { id: askedId, row: askedRow, at } = state.asked;
  if (askedId === id && askedRow === row && Date.now() - at < DETAIL_MAX_AGE_MS) return;
  const asked = { id, row, at: Date.now() };
  state.asked = asked;
  const stale = () => selected() !== id || state.asked !== asked;
  const path = `/v1/actuators/${encodeURIComponent(id)}`;
  try {
    const [record, health, life, maintenance, trend, alerts] = await Promise.all([
      get(path), getAll(`${path}/health?limit=500`), get(`${path}/remaining-life`), getAll(`${path}/maintenance?limit=500`),
      tryAll(`${path}/remaining-life/trend?limit=500`), tryAll(`${path}/alerts?limit=100`, 1),
    ]);
    if (stale()) return;
    state.detail = { record, history: health.items, truncated: health.truncated, life, maintenance: maintenance.items, trend, alerts };
    state.detailProblem = null;
  } catch (error) {
    if (stale()) return;
    state.detailProblem = asProblem(error);
  }
  renderDetail();
}

function render() {
  renderLive();
  renderJobs();
  renderNotice();
  if (state.rows) {
    byId("fleet").hidden = false;
    const pieces = summary(state.rows);
    refill(byId("summary"), pieces, () => pieces.map(({ text, tone }) => h("span", { "data-tone": tone }, text)));
    renderAlerts();
    drawFleet({ ...state, selected: selected() }, act);
  } else if (state.problem) {
    refill(byId("summary"), "unread", () => "The fleet could not be read");
    byId("rows").replaceChildren();
    byId("fleet").hidden = true;
  }
  renderDetail();
}

function renderAlerts() {
  const { alerts, allAlerts } = state;
  byId("alerts").hidden = state.rows.length === 0;
  refill(byId("alerts"), [alerts, alerts.problem?.detail, allAlerts], () => fleetAlerts(alerts, allAlerts, () => { state.allAlerts = true; render(); }));
  byId("alarm").hidden = alerts.items.length === 0;
  byId("alarm").textContent = counted(alerts.items.length, "alert");
  byId("alarm").title = tally(alerts.items);
}

function renderLive() {
  const late = state.problem !== null;
  byId("live").dataset.state = late ? "stale" : state.updated ? "live" : "waiting";
  const time = state.updated ? clock(state.updated) : null;
  byId("live-text").textContent = late ? (time ? `Stale, last update ${time}` : "No data yet") : time ? `Updated ${time}` : "Connecting";
}

function renderJobs() {
  if (!state.jobs) return;
  const { running, queued } = state.jobs;
  const count = ({ items, next_cursor: more }) => `${items.length}${more ? "+" : ""}`;
  const progress = running.items.reduce((sum, job) => sum + (job.progress ?? 0), 0) / (running.items.length || 1);
  refill(byId("jobs"), [count(running), count(queued), Math.round(progress * 100)], () => {
    if (running.items.length + queued.items.length === 0) return ["No jobs waiting"];
    return [
      h("span", {}, h("b", {}, count(running)), " running"),
      running.items.length > 0 && h("progress", { max: 1, value: progress, "aria-label": `Mean progress ${percent(progress)}` }),
      h("span", {}, h("b", {}, count(queued)), " queued"),
    ].filter(Boolean);
  });
}

function renderNotice() {
  const box = byId("notice");
  box.hidden = state.problem === null;
  refill(box, problemData(state.problem), () => (state.problem ? problemPieces(state.problem) : []));
}

const problemData = (problem) => problem && [problem.status, problem.title, problem.detail, problem.errors];

function problemPieces(problem) {
  return [
    h("h3", {}, problem.title),
    h("p", {}, problem.detail),
    problem.errors.length > 0 && h("ul", {}, problem.errors.map((error) => h("li", {}, h("code", {}, error.pointer), ` ${error.detail}`))),
    problem.requestId && h("p", { class: "hint" }, "Request ", h("code", {}, problem.requestId)),
    h("button", { type: "button", class: "quiet", "data-focus": "retry", onclick: retry }, "Try again"),
  ].filter(Boolean);
}

function retry() {
  state.asked = {};
  poll();
}

function renderDetail() {
  const id = selected();
  const pane = byId("detail");
  document.body.dataset.view = state.chosen === null ? "fleet" : "detail";
  document.body.toggleAttribute("data-single", id === null);
  pane.hidden = id === null;
  byId("skip").hidden = id === null;
  document.title = titleOf();
  if (id === null) return;
  if (state.detail?.record.id === id) {
    drawActuator(pane, state.detail, { open: state.historyShown, answers: state.answers }, act);
  } else if (state.detailProblem) {
    const problem = state.detailProblem;
    reconcile(pane, [{ key: "problem", data: problemData(problem), draw: () => h("div", {}, back(), h("div", { class: "notice" }, problemPieces(problem))) }]);
  } else {
    const bones = ["bone bone-title", "bone bone-line", "bone bone-chart", "bone bone-chart"];
    reconcile(pane, [{ key: "bones", data: "", draw: () => h("div", { "aria-busy": "true" }, back(), bones.map((name) => h("div", { class: name }))) }]);
  }
}

/** The actuator that the address names, else how many ask for action. */
function titleOf() {
  const { chosen, detail, rows } = state;
  if (chosen !== null && detail?.record.id === chosen) return `${detail.record.serial_number} · elevon`;
  const urgent = (rows ?? []).filter((row) => statusOf(row) === "act").length;
  return urgent > 0 ? `(${urgent}) elevon` : "elevon";
}

function unescaped(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** `#/actuators/ID` is an actuator, `#/alerts` the fleet's alerts, all else the fleet. */
function follow() {
  const match = location.hash.match(/^#\/actuators\/(.+)$/);
  const before = selected();
  state.chosen = match ? unescaped(match[1]) : null;
  if (DESK.matches && state.chosen) state.preview = state.chosen;
  if (selected() !== before) {
    Object.assign(state, { detailProblem: null, historyShown: 0 });
    byId("detail").scrollTop = 0;
  }
  render();
  if (!DESK.matches) {
    scrollTo(0, 0);
    if (state.chosen) byId("detail").focus({ preventScroll: true });
  }
  if (location.hash === "#/alerts") {
    byId("alerts").scrollIntoView({ block: "nearest" });
    byId("alerts").focus({ preventScroll: true });
  }
  refreshDetail();
}

function listen() {
  addEventListener("hashchange", follow);
  DESK.addEventListener("change", () => { render(); refreshDetail(); });
  document.addEventListener("visibilitychange", () => (document.hidden ? clearTimeout(timer) : poll()));
  byId("rows").addEventListener("keydown", onRowKey);
  byId("tail").addEventListener("change", (event) => { state.filter.tail = event.target.value; render(); });
  byId("text").addEventListener("input", (event) => { state.filter.text = event.target.value.trim(); render(); });
  byId("alarm").addEventListener("click", () => location.hash === "#/alerts" && follow());
  byId("skip").addEventListener("click", (event) => { event.preventDefault(); byId("detail").focus(); });
}

listen();
follow();
poll();
get("/openapi.json").then(({ info }) => { byId("version").textContent = info.version; }, () => {});
