// The tab Change: colours of categories, and the operations of `vtex edit`.

import { tell } from "./server.js";
import { explanation, fill, make, throttled } from "./dom.js";
import { control } from "./knobs.js";

const RECOLOUR = /^recolor --from (#[0-9a-f]{6}) --to (#[0-9a-f]{6}) --reach 2 --where category=(\d+)$/;

/** The text of an operation. Words with blanks are quoted. */
function operationText(operation, values, layer, where) {
  const quote = value => /\s/.test(value) ? `'${value}'` : value;
  const given = operation.knobs.filter(knob => values[knob.name] !== undefined && values[knob.name] !== null);
  const placed = given.filter(knob => knob.placed).map(knob => quote(values[knob.name]));
  const named = given.filter(knob => !knob.placed).flatMap(knob => [`--${knob.name}`, quote(values[knob.name])]);
  const selected = [...(layer ? ["--layer", quote(layer)] : []), ...(where ? ["--where", quote(where)] : [])];
  return [operation.name, ...placed, ...named, ...selected].join(" ");
}

export class Change {
  constructor(panel, table) {
    this.table = table;
    this.values = {};
    this.chosen = "shadow";
    this.colours = make("div");
    this.done = make("div");
    this.adding = make("div");
    fill(panel, this.colours, this.done, this.adding);
  }

  show(work) {
    this.work = work;
    const inUse = part => part.contains(document.activeElement);
    const kinds = JSON.stringify([work.name, work.texture?.categories, work.texture?.layers]);
    const active = document.activeElement;
    if (!(inUse(this.colours) && active.type === "color")) this.showColours();
    this.showDone();
    if (kinds !== this.kinds && !inUse(this.adding)) {
      this.kinds = kinds;
      this.showAdding();
    }
  }

  /** The operation that recolours a category, if there is one: its index. */
  recoloured(number) {
    return this.work.operations.findIndex(text => RECOLOUR.exec(text)?.[3] === String(number));
  }

  recolour(category, colour) {
    const operations = [...this.work.operations];
    const at = this.recoloured(category.category);
    const text = `recolor --from ${category.colour} --to ${colour} --reach 2 --where category=${category.category}`;
    if (colour === null) operations.splice(at, 1);
    else if (at >= 0) operations[at] = text;
    else operations.push(text);
    this.work.operations = operations;
    return tell("operations", { operations, what: colour === null ? "" : `category ${category.category}` });
  }

  showColours() {
    const categories = this.work.texture?.categories ?? [];
    const one = new Set(categories.map(category => category.library)).size <= 1;
    const rows = one ? categories.map(category => {
      const at = this.recoloured(category.category);
      const now = at >= 0 ? RECOLOUR.exec(this.work.operations[at])[2] : category.colour;
      const picker = make("input", { type: "color", value: now, "aria-label": `Colour of ${category.name}`, "data-key": `colour-${category.category}` });
      picker.addEventListener("input", throttled(() => this.recolour(category, picker.value), 160));
      picker.addEventListener("change", () => this.recolour(category, picker.value));
      return make("li", {}, picker, make("span", { className: "name", textContent: category.name }),
        make("span", { className: "count", textContent: `${category.elements} elements` }),
        at >= 0 ? make("button", { type: "button", className: "plain", textContent: "Reset", "aria-label": `Reset the colour of ${category.name}`, onclick: () => this.recolour(category, null) }) : null);
    }) : [];
    fill(this.colours, make("h2", { textContent: "Colours" }),
      rows.length ? make("ul", { className: "list" }, ...rows)
        : make("p", { textContent: "Elements have no categories here. Operations change all of them." }));
  }

  showDone() {
    const { operations } = this.work;
    const put = next => tell("operations", { operations: next, what: "" });
    const rows = operations.map((text, index) => {
      const button = (sign, label, key, action, disabled = false) => make("button", { type: "button", className: "plain", textContent: sign, "aria-label": `${label}: ${text}`, title: label, disabled, "data-key": `${key}-${index}`, onclick: action });
      const swap = () => { const next = [...operations]; [next[index - 1], next[index]] = [next[index], next[index - 1]]; put(next); };
      return make("li", {}, make("code", { textContent: text }),
        button("↑", "Do it earlier", "up", swap, index === 0),
        button("×", "Remove", "remove", () => put(operations.filter((_, other) => other !== index))));
    });
    fill(this.done, rows.length ? make("h2", { textContent: "Operations, in their order" }) : null,
      rows.length ? make("ol", { className: "list" }, ...rows) : null);
  }

  showAdding() {
    const operation = this.table.operations.find(known => known.name === this.chosen);
    const select = make("select", { id: "operation", "aria-describedby": "operation-words" }, ...this.table.operations.map(known =>
      make("option", { value: known.name, textContent: known.name, selected: known.name === this.chosen })));
    select.addEventListener("change", () => { this.chosen = select.value; this.values = {}; this.showAdding(); find(this.adding, "operation").focus(); });
    const knobs = operation.knobs.map(knob => {
      const id = `word-${knob.name}`;
      const parts = control(knob, this.values[knob.name], value => { this.values[knob.name] = value; }, { id, live: true });
      return make("div", { className: "knob" },
        make("div", { className: "head" }, make("label", { for: id, textContent: knob.name }), knob.kind === "switch" ? parts[0] : null),
        knob.kind === "switch" ? null : make("div", { className: "control" }, ...parts),
        explanation(`${id}-words`, knob.takes ? `${knob.words} [${knob.takes}]` : knob.words));
    });
    const layers = this.work.texture?.layers ?? [], categories = this.work.texture?.categories ?? [];
    const option = (value, text) => make("option", { value, textContent: text });
    const which = make("select", { id: "which" }, option("", "all elements"),
      ...layers.map(name => option(`layer:${name}`, `layer ${name}`)),
      ...categories.map(({ category, name }) => option(`category:${category}`, `category ${category}, ${name}`)));
    const add = async () => {
      const [kind, name] = which.value.split(/:(.*)/s);
      const text = operationText(operation, this.values, kind === "layer" ? name : "", kind === "category" ? `category=${name}` : "");
      await tell("operations", { operations: [...this.work.operations, text], what: "" });
    };
    fill(this.adding, make("h2", { textContent: "Add an operation" }),
      make("form", { className: "form", onsubmit: event => { event.preventDefault(); add(); } },
        make("div", { className: "knob" }, make("div", { className: "head" }, make("label", { for: "operation", textContent: "Operation" })),
          make("div", { className: "control" }, select), explanation("operation-words", operation.words)),
        ...knobs,
        make("div", { className: "knob" }, make("div", { className: "head" }, make("label", { for: "which", textContent: "Done to" })), make("div", { className: "control" }, which)),
        make("div", { className: "row" }, make("button", { type: "submit", className: "primary", textContent: "Add" }))));
  }
}

const find = (parent, id) => parent.querySelector(`#${CSS.escape(id)}`);
