// The tab Change: colours of categories, and the operations of `vtex edit`.

import { tell } from "./server.js";
import { explanation, fill, make, throttled } from "./dom.js";
import { control } from "./knobs.js";

const PALETTE_SIDE = 96;
const RECOLOUR = /^recolor --from (#[0-9a-f]{6}) --to (#[0-9a-f]{6}) --reach 2(?: --keep details)? --where category=(\d+)$/;

/** The text of an operation. Words with blanks are quoted. */
function operationText(operation, values, layer, where) {
  const quote = value => /\s/.test(value) ? `'${value}'` : value;
  const given = operation.knobs.filter(knob => values[knob.name] !== undefined && values[knob.name] !== null);
  const placed = given.filter(knob => knob.placed).map(knob => quote(values[knob.name]));
  const named = given.filter(knob => !knob.placed).flatMap(knob => [`--${knob.name}`, quote(values[knob.name])]);
  const selected = [...(layer ? ["--layer", quote(layer)] : []), ...(where ? ["--where", quote(where)] : [])];
  return [operation.name, ...placed, ...named, ...selected].join(" ");
}

/** The means of clusters of a picture's colours, one a line, from dark to light. */
async function coloursOf(file, count) {
  const image = await createImageBitmap(file);
  const by = Math.min(1, PALETTE_SIDE / Math.max(image.width, image.height));
  const size = [image.width, image.height].map(side => Math.max(1, Math.round(side * by)));
  const canvas = make("canvas", { width: size[0], height: size[1] });
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0, ...size);
  const { data } = context.getImageData(0, 0, ...size);
  const light = ([r, g, b]) => 0.3 * r + 0.59 * g + 0.11 * b;
  const pixels = [];
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 127) pixels.push([data[i], data[i + 1], data[i + 2]]);
  pixels.sort((a, b) => light(a) - light(b));
  let means = Array.from({ length: count }, (_, k) => pixels[Math.floor((k + 0.5) * pixels.length / count)] ?? [0, 0, 0]);
  for (let round = 0; round < 12; round++) {
    const sums = means.map(() => [0, 0, 0, 0]);
    for (const pixel of pixels) {
      const far = means.map(mean => mean.reduce((sum, value, c) => sum + (value - pixel[c]) ** 2, 0));
      const sum = sums[far.indexOf(Math.min(...far))];
      pixel.forEach((value, c) => { sum[c] += value; });
      sum[3] += 1;
    }
    means = sums.map((sum, k) => sum[3] ? sum.slice(0, 3).map(value => value / sum[3]) : means[k]);
  }
  const hex = mean => `#${mean.map(value => Math.round(value).toString(16).padStart(2, "0")).join("")}`;
  return `${means.sort((a, b) => light(a) - light(b)).map(hex).join("\n")}\n`;
}

export class Change {
  constructor(panel, table, view) {
    this.table = table;
    this.view = view;
    // Older programs recolour elements as wholes.
    const recolor = table.operations.find(operation => operation.name === "recolor");
    this.canKeep = Boolean(recolor?.knobs.some(knob => knob.name === "keep"));
    this.keepsDetails = false;
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
    const kinds = JSON.stringify([work.id, work.texture?.categories, work.texture?.layers]);
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
    // Other operations may have changed the colour before.
    const from = at >= 0 ? RECOLOUR.exec(operations[at])[1] : category.now;
    const text = `recolor --from ${from} --to ${colour} --reach 2${this.keepsDetails ? " --keep details" : ""} --where category=${category.category}`;
    if (colour === null) operations.splice(at, 1);
    else if (at >= 0) operations[at] = text;
    else operations.push(text);
    this.work.operations = operations;
    return tell("operations", { operations, what: colour === null ? "" : `category ${category.category}` });
  }

  showColours() {
    const categories = this.work.texture?.categories ?? [];
    const one = new Set(categories.map(category => category.library)).size <= 1;
    const excluded = (this.work.options.exclude ?? "").split(",").filter(Boolean);
    const rows = one ? categories.map(category => {
      const at = this.recoloured(category.category);
      const now = at >= 0 ? RECOLOUR.exec(this.work.operations[at])[2] : category.now;
      const picker = make("input", { type: "color", value: now, "aria-label": `Colour of ${category.name}`, "data-key": `colour-${category.category}` });
      picker.addEventListener("input", throttled(() => this.recolour(category, picker.value), 160));
      picker.addEventListener("change", () => this.recolour(category, picker.value));
      return make("li", {}, picker, this.pipette(`colour of ${category.name}`, colour => this.recolour(category, colour)), make("span", { className: "name", textContent: category.name }),
        make("span", { className: "count", textContent: category.elements, title: "Elements placed" }),
        this.leavingOut(category.name, excluded),
        at >= 0 ? make("button", { type: "button", className: "plain", textContent: "Reset", "aria-label": `Reset the colour of ${category.name}`, onclick: () => this.recolour(category, null) }) : null);
    }) : [];
    const shown = categories.map(category => category.name);
    rows.push(...excluded.filter(name => !shown.includes(name)).map(name =>
      make("li", {}, make("span", { className: "name", textContent: name }), this.leavingOut(name, excluded))));
    fill(this.colours, make("h2", { textContent: "Categories" }),
      rows.length ? make("ul", { className: "list" }, ...rows)
        : make("p", { textContent: "Elements have no categories here. Operations change all of them." }),
      rows.length && this.canKeep ? this.keeping() : null,
      rows.length ? this.palette(categories.length) : null);
  }

  /** The switch by which details keep their colours when a category is recoloured. */
  keeping() {
    const box = make("input", { type: "checkbox", checked: this.keepsDetails, "data-key": "keep-details" });
    box.addEventListener("change", () => { this.keepsDetails = box.checked; });
    return make("div", { className: "row" }, make("label", { className: "check" }, box, " Details keep their colours"));
  }

  /** A button after which the colour that is pressed in the picture is taken. */
  pipette(what, onpick) {
    const button = make("button", { type: "button", className: "pipette", "aria-label": `Take the ${what} from the picture`, title: "Press a place of the picture to take its colour", "aria-pressed": "false" });
    button.addEventListener("click", () => {
      const isOn = this.view.pipette === null;
      button.setAttribute("aria-pressed", String(isOn));
      this.view.pipette = isOn ? colour => { button.setAttribute("aria-pressed", "false"); if (colour) onpick(colour); } : null;
    });
    return button;
  }

  /** The switch that leaves a category out of the texture, or takes it in again. A scene is placed already. */
  leavingOut(name, excluded) {
    if (this.work.kind === "scene") return null;
    const isOut = excluded.includes(name);
    const next = isOut ? excluded.filter(other => other !== name) : [...excluded, name];
    return make("button", { type: "button", "aria-pressed": String(isOut), textContent: "Leave out", "aria-label": `Leave out ${name}`, title: "Its elements are not placed", "data-key": `out-${name}`, onclick: () => tell("set", { name: "exclude", value: next.join(",") || null }) });
  }

  /** Colours taken from a picture, or from a file that lists them. */
  palette(count) {
    const known = this.work.files.palette;
    const input = make("input", { type: "file", hidden: true, accept: "image/*,.gpl,.txt", tabIndex: -1, "aria-label": "Palette from a picture" });
    input.addEventListener("change", async () => {
      const [file] = input.files;
      if (!file) return;
      const colours = file.type.startsWith("image/") ? await coloursOf(file, count) : await file.text();
      const name = `${file.name.replace(/\.[^.]*$/, "")}.colours.txt`;
      await tell("side", new Blob([colours]), { option: "palette", name: file.type.startsWith("image/") ? name : file.name });
      input.value = "";
    });
    return make("div", { className: "row" }, input,
      make("button", { type: "button", textContent: "Palette from a picture…", title: "The texture takes its colours, from dark to light", "data-key": "palette", onclick: () => input.click() }),
      known ? make("span", { className: "name", textContent: known.name }) : null,
      known ? make("button", { type: "button", className: "plain", textContent: "Reset", "aria-label": "Reset the palette", "data-key": "palette-reset", onclick: () => tell("side", new Blob([]), { option: "palette" }) }) : null);
  }

  showDone() {
    const { operations } = this.work;
    const put = next => tell("operations", { operations: next, what: "" });
    const rows = operations.map((text, index) => {
      const button = (sign, label, key, action, disabled = false) => make("button", { type: "button", className: "plain", textContent: sign, "aria-label": `${label}: ${text}`, title: label, disabled, "data-key": `${key}-${index}`, onclick: action });
      const swap = () => { const next = [...operations]; [next[index - 1], next[index]] = [next[index], next[index - 1]]; put(next); };
      return make("li", {}, make("code", { textContent: text }),
        button("↑", "Move up", "up", swap, index === 0),
        button("×", "Remove", "remove", () => put(operations.filter((_, other) => other !== index))));
    });
    fill(this.done, rows.length ? make("h2", { textContent: "Operations, run from top to bottom" }) : null,
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
        make("div", { className: "knob" }, make("div", { className: "head" }, make("label", { for: "which", textContent: "Apply to" })), make("div", { className: "control" }, which)),
        make("div", { className: "row" }, make("button", { type: "submit", className: "primary", textContent: "Add" }))));
  }
}

const find = (parent, id) => parent.querySelector(`#${CSS.escape(id)}`);
