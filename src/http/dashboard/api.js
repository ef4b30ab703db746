/** The service's JSON: conditional requests, paging, changes, problem documents. */

const TIMEOUT_MS = 15_000;
const PAGES_MAX = 20;

/** A failed request, as its RFC 9457 problem document tells it. */
export class Problem extends Error {
  constructor({ status, title, detail, errors = [], request_id: requestId = null, retryAfterS = null }) {
    super(detail);
    Object.assign(this, { status, title, detail, errors, requestId, retryAfterS });
  }
}

/** What failed, as a problem. */
export function asProblem(error) {
  return error instanceof Problem ? error : new Problem({ status: 0, title: "The dashboard failed", detail: String(error) });
}

/** One JSON document. `no-cache` lets the browser answer a 304 from its own copy. */
export function get(path) {
  return ask(path, { headers: { Accept: "application/json" }, cache: "no-cache" });
}

/** Changes a record, and answers what it is now. */
export function patch(path, body) {
  return ask(path, { method: "PATCH", headers: { Accept: "application/json", "Content-Type": "application/json" }, body: JSON.stringify(body) });
}

async function ask(path, options) {
  let response;
  try {
    response = await fetch(path, { ...options, signal: AbortSignal.timeout(TIMEOUT_MS) });
  } catch (error) {
    const late = error.name === "TimeoutError";
    throw new Problem({
      status: 0,
      title: late ? "No answer in time" : "The service cannot be reached",
      detail: late ? `${path} did not answer within ${TIMEOUT_MS / 1000} s.` : `${location.origin} does not answer.`,
    });
  }
  if (!response.ok) throw await problemOf(response);
  return response.json();
}

async function problemOf(response) {
  const body = await response.json().catch(() => ({}));
  return new Problem({
    ...body,
    status: response.status,
    title: body.title ?? `Status ${response.status}`,
    detail: body.detail ?? `${response.url} answered ${response.status} ${response.statusText}.`,
    retryAfterS: Number(response.headers.get("Retry-After")) || null,
  });
}

/** Every item of a list, page after page; `truncated` says that the service has more than was read. */
export async function getAll(path, pagesMax = PAGES_MAX) {
  const items = [];
  let cursor = null;
  for (let page = 0; page < pagesMax; page += 1) {
    const answer = await get(cursor === null ? path : `${path}&cursor=${encodeURIComponent(cursor)}`);
    items.push(...answer.items);
    cursor = answer.next_cursor;
    if (cursor === null || cursor === undefined) return { items, truncated: false };
  }
  return { items, truncated: true };
}

/** As `getAll`, with the failure as `problem`: for what the page can do without. */
export async function tryAll(path, pagesMax = PAGES_MAX) {
  try {
    return { ...await getAll(path, pagesMax), problem: null };
  } catch (error) {
    return { items: [], truncated: false, problem: asProblem(error) };
  }
}
