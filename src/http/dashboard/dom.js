/** Element builders and in-place updates. Data reaches the page as text nodes and attributes only. */

const SVG = "http://www.w3.org/2000/svg";
const signatures = new WeakMap();

function furnish(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** An HTML element; an `on...` attribute is a listener; null, undefined and false are left out. */
export function h(tag, attributes = {}, ...children) {
  return furnish(document.createElement(tag), attributes, children);
}

/** An SVG element, as `h`. */
export function s(tag, attributes = {}, ...children) {
  return furnish(document.createElementNS(SVG, tag), attributes, children);
}

/** The element of the page with this id. */
export function byId(id) {
  return document.getElementById(id);
}

/** Replaces an element's children, unless the data they were drawn from is unchanged. */
export function refill(element, data, draw) {
  const signature = JSON.stringify(data);
  if (signatures.get(element) === signature) return;
  signatures.set(element, signature);
  keepingFocus(element, () => element.replaceChildren(...[draw()].flat(Infinity)));
}

/**
 * Makes a container hold one element per entry `{key, data, draw}`, in order. An element is redrawn only
 * when its data changed, so that a poll without news touches nothing.
 */
export function reconcile(container, entries) {
  const old = new Map([...container.children].map((node) => [node.dataset.key, node]));
  const wanted = entries.map(({ key, data, draw }) => {
    const signature = JSON.stringify(data);
    const kept = old.get(key);
    if (kept && signatures.get(kept) === signature) return kept;
    const node = draw();
    node.dataset.key = key;
    signatures.set(node, signature);
    return node;
  });
  keepingFocus(container, () => {
    const keep = new Set(wanted);
    for (const node of [...container.children]) if (!keep.has(node)) node.remove();
    wanted.forEach((node, index) => {
      if (container.children[index] !== node) container.insertBefore(node, container.children[index] ?? null);
    });
  });
}

function keepingFocus(container, change) {
  const active = document.activeElement;
  const name = container.contains(active) ? active.dataset.focus : undefined;
  change();
  if (name === undefined || document.activeElement === active) return;
  container.querySelector(`[data-focus="${CSS.escape(name)}"]`)?.focus({ preventScroll: true });
}
