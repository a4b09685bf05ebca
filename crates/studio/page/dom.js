// Making and finding the parts of the page. All text is set as text, never as markup.

export const find = id => document.getElementById(id);

/** An element with properties, attributes (`aria-…`, `role`, `for`), listeners (`on…`) and children. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element && !name.startsWith("aria")) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children.filter(child => child !== null && child !== undefined));
  return element;
}

/** What explains a control; it is referred to by its id. */
export function explanation(id, text) {
  return make("p", { className: "words", id }, make("span", { textContent: text }));
}

/** Replaces the children of an element, and keeps the focus on the one with the same `data-key`. */
export function fill(parent, ...children) {
  const key = parent.contains(document.activeElement) ? document.activeElement.dataset.key : undefined;
  parent.replaceChildren(...children.filter(child => child !== null && child !== undefined));
  if (key) parent.querySelector(`[data-key="${CSS.escape(key)}"]`)?.focus();
}

/** A call that waits for a moment without further ones; the last one counts. */
export function settled(action, milliseconds) {
  let timer;
  return (...values) => {
    clearTimeout(timer);
    timer = setTimeout(() => action(...values), milliseconds);
  };
}

/** Calls an action at once, and then at most every so often, with the newest values. */
export function throttled(action, milliseconds) {
  let last = 0, timer;
  return (...values) => {
    clearTimeout(timer);
    const wait = last + milliseconds - performance.now();
    const go = () => { last = performance.now(); action(...values); };
    if (wait <= 0) go(); else timer = setTimeout(go, wait);
  };
}

/** Tells the user something, until it is put away. */
export function notice(text, { hint, fault = false, key } = {}) {
  const place = find("notices");
  for (const old of place.children) if (key && old.dataset.of === key) old.remove();
  const box = make("div", { className: fault ? "notice fault" : "notice" },
    make("div", {}, make("p", { textContent: text }), hint ? make("p", { className: "hint", textContent: hint }) : null),
    make("button", { type: "button", className: "plain", textContent: "×", "aria-label": "Close", onclick: () => box.remove() }));
  if (key) box.dataset.of = key;
  place.append(box);
  while (place.children.length > 3) place.firstChild.remove();
  if (!fault) setTimeout(() => box.remove(), 8000);
}

export function forget(key) {
  for (const old of [...find("notices").children]) if (old.dataset.of === key) old.remove();
}
