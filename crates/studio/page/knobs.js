// The tab Steer: seed, variants, and every option with the words and the range that the program has for it.

import { ask, tell } from "./server.js";
import { explanation, fill, make, throttled } from "./dom.js";
import { labelOf } from "./labels.js";

/** Options that lie open; others are under a heading that opens. */
const CLOSED = new Set(["Analysis", "File"]);
const SLIDER = 1000;

const CAPITALS = new Set(["dpi", "css"]);
const words = name => CAPITALS.has(name) ? name.toUpperCase() : name[0].toUpperCase() + name.slice(1).replaceAll("-", " ");

/** A control for a knob. `onset` gets its value as text, or null for the default. */
export function control(knob, value, onset, { id, live = true } = {}) {
  const placeholder = knob.default ?? "";
  const attributes = { id, "aria-describedby": `${id}-words` };
  const send = throttled(onset, 140);
  if (knob.kind === "number") {
    // Some defaults are words, which its own words tell.
    const hasNumber = knob.default && !Number.isNaN(Number(knob.default));
    const shown = value ?? (hasNumber ? knob.default : "");
    const step = knob.whole ? 1 : "any";
    const number = make("input", { type: "number", min: knob.least, max: knob.most, step, value: shown, placeholder: hasNumber ? placeholder : "auto", ...attributes });
    number.addEventListener("change", () => onset(number.value === "" ? null : number.value));
    if (knob.most - knob.least > SLIDER) return [number];
    const span = knob.most - knob.least;
    const slider = make("input", {
      type: "range", min: knob.least, max: knob.most, step: knob.whole ? 1 : span / 200,
      value: shown === "" ? knob.least : shown, "aria-label": words(knob.name),
    });
    const tidy = () => knob.whole ? slider.value : String(+Number(slider.value).toPrecision(4));
    slider.addEventListener("input", () => { number.value = tidy(); if (live) send(number.value); });
    slider.addEventListener("change", () => { number.value = tidy(); onset(number.value); });
    number.addEventListener("input", () => { if (number.value !== "") slider.value = number.value; });
    return [slider, number];
  }
  if (knob.kind === "switch") {
    const box = make("input", { type: "checkbox", checked: value === "true" || value === "", ...attributes });
    box.addEventListener("change", () => onset(box.checked ? "true" : null));
    return [box];
  }
  if (knob.kind === "choice") {
    const select = make("select", attributes);
    if (!knob.choices.includes(knob.default)) select.append(make("option", { value: "", textContent: knob.needed ? "choose…" : "default" }));
    for (const choice of knob.choices) select.append(make("option", { value: choice, textContent: choice }));
    select.value = value ?? (knob.choices.includes(knob.default) ? knob.default : "");
    select.addEventListener("change", () => onset(select.value === "" || select.value === knob.default ? null : select.value));
    return [select];
  }
  const text = make("input", { type: "text", value: value ?? "", placeholder, spellcheck: false, autocomplete: "off", ...attributes });
  text.addEventListener("change", () => onset(text.value.trim() === "" ? null : text.value.trim()));
  if (knob.kind !== "colour") return [text];
  const hex = /^#[0-9a-f]{6}$/i.test(value ?? "") ? value : "#ffffff";
  const colour = make("input", { type: "color", value: hex, "aria-label": `${words(knob.name)}: colour` });
  colour.addEventListener("input", () => { text.value = colour.value; if (live) send(colour.value); });
  colour.addEventListener("change", () => onset(colour.value));
  return [colour, text];
}

/** A knob with its name, its control and its words. */
export function row(knob, value, onset, { id, parts }) {
  const set = value !== undefined && value !== null;
  const reset = make("button", { type: "button", className: "plain", textContent: "Reset", hidden: !set, "aria-label": `Reset ${words(knob.name)}`, onclick: () => onset(null) });
  parts ??= control(knob, value, onset, { id });
  const inline = knob.kind === "switch";
  return make("div", { className: set ? "knob set" : "knob" },
    make("div", { className: "head" }, make("label", { for: id, textContent: words(knob.name) }), inline ? parts[0] : null, reset),
    inline ? null : make("div", { className: "control" }, ...parts),
    explanation(`${id}-words`, labelOf(knob)));
}

/** Units of the canvas, in millimetres. */
const UNITS = { px: 25.4 / 96, mm: 1, cm: 10, m: 1000, in: 25.4, pt: 25.4 / 72 };

/** The canvas in pixels or lengths. */
function sizeControl(id, value, texture, onset) {
  const match = /^([\d.]+)\s*(px|mm|cm|m|in|pt)?(?:\s*x\s*([\d.]+)\s*(px|mm|cm|m|in|pt)?)?$/.exec(value ?? "") ?? [];
  const unit = match[2] ?? "px";
  // A page that was not asked for does not say how many units of a drawing it has.
  const own = texture?.page ? ["", ""] : texture?.whole ?? ["", ""];
  const width = match[1] ?? own[0], height = match[3] ?? match[1] ?? own[1];
  const side = (value, label, own) => make("input", { type: "number", min: 0, step: "any", value, placeholder: "auto", "aria-label": label, id: own, "aria-describedby": own ? `${id}-words` : undefined });
  const sides = [side(width, "Width of the canvas", id), side(height, "Height of the canvas")];
  const units = make("select", { "aria-label": "Unit of the canvas" }, ...Object.keys(UNITS).map(name => make("option", { value: name, textContent: name, selected: name === unit })));
  const send = () => {
    const end = units.value === "px" ? "" : units.value;
    const [w, h] = sides.map(input => input.value.trim());
    if (w || h) onset(`${w || h}${end}x${h || w}${end}`);
  };
  for (const input of sides) {
    input.addEventListener("change", send);
    // What is typed takes the place of what was there.
    input.addEventListener("focus", () => input.select());
  }
  let before = unit;
  units.addEventListener("change", () => {
    const by = UNITS[before] / UNITS[before = units.value];
    const inUnits = value => before === "px" ? Math.max(1, Math.round(value)) : Number(value.toPrecision(4));
    for (const input of sides) if (input.value) input.value = inUnits(input.value * by);
    send();
  });
  return [make("div", { className: "pair" }, sides[0], make("span", { textContent: "×", "aria-hidden": "true" }), sides[1], units)];
}

/** The tab Steer. */
export class Steer {
  constructor(panel, table, paint) {
    this.paint = paint;
    paint.onchange = () => this.showGroups(this.work);
    this.panel = panel;
    this.table = table;
    this.pictures = new Map();
    this.rows = new Map();
    this.seed = make("div");
    this.groups = make("div");
    fill(panel, this.seed, this.groups);
  }

  show(work) {
    this.work = work;
    if (work.kind === "scene") {
      fill(this.seed, make("p", { textContent: "A scene is placed already. It can be changed and saved; to place its elements anew, open its library or its photograph." }));
    } else this.showSeed(work);
    // A control that is in use stays as it is.
    if (!this.groups.contains(document.activeElement) || document.activeElement.tagName === "SUMMARY" || (document.activeElement.dataset.key && document.activeElement.type !== "range") || this.of !== work.id) this.showGroups(work);
    else this.refresh(work);
  }

  showSeed(work) {
    const field = make("input", { type: "text", inputMode: "numeric", value: work.seed, id: "seed", spellcheck: false, autocomplete: "off", "data-key": "seed" });
    field.addEventListener("change", () => tell("seed", { seed: field.value.trim() }));
    const dice = make("button", { type: "button", textContent: "⚄ New seed", title: "Any other seed (D)", "data-key": "dice", onclick: () => tell("seed", { seed: null }) });
    const shown = work.variants.show;
    const toggle = make("button", { type: "button", "aria-pressed": String(shown), textContent: "Variants", title: "Six other seeds", "data-key": "variants", onclick: () => tell("variants", { show: !shown, more: false }) });
    const parts = [make("div", { className: "row seed" }, make("label", { for: "seed", textContent: "Seed" }), field, dice, toggle)];
    if (shown) parts.push(this.variants(work));
    const facts = work.analysis && work.texture ? make("p", { className: "facts" },
      make("span", {}, make("b", { textContent: work.analysis.primaries }), " elements found"),
      make("span", {}, make("b", { textContent: work.analysis.secondaries }), " small ones"),
      make("span", {}, make("b", { textContent: work.texture.elements }), " placed")) : null;
    fill(this.seed, facts, ...parts);
  }

  variants(work) {
    const made = new Map(work.variants.made.map(({ seed }) => [seed, true]));
    const grid = make("div", { className: "variants", role: "group", "aria-label": "Variants" });
    for (const seed of made.keys()) {
      const image = make("img", { alt: "" });
      this.thumbnail(work, seed).then(address => { image.src = address; }, () => {});
      grid.append(make("button", { type: "button", "aria-label": `Seed ${seed}`, title: `Seed ${seed}`, "aria-pressed": String(seed === work.seed), "data-key": `variant-${seed}`, onclick: () => tell("seed", { seed }) }, image));
    }
    const { fault } = work.variants;
    if (fault) return make("div", {}, grid, make("p", { className: "fault", role: "alert", textContent: `Variants could not be made: ${fault.error}` }),
      make("div", { className: "row" }, make("button", { type: "button", className: "plain", textContent: "Try again", "data-key": "more", onclick: () => tell("variants", { show: true, more: false }) })));
    for (let missing = made.size; missing < 6; missing++) grid.append(make("div", { className: "wait", textContent: "…", "aria-hidden": "true" }));
    return make("div", {}, grid, make("div", { className: "row" }, make("button", { type: "button", className: "plain", textContent: "Six more", "data-key": "more", onclick: () => tell("variants", { show: true, more: true }) })));
  }

  /** The address of the small picture of a seed, as long as what is set stays the same. */
  thumbnail(work, seed) {
    const key = JSON.stringify([work.id, work.options, work.operations, work.files, work.elements?.version, seed]);
    if (!this.pictures.has(key)) {
      if (this.pictures.size > 60) {
        for (const address of this.pictures.values()) address.then(URL.revokeObjectURL, () => {});
        this.pictures.clear();
      }
      const picture = ask("variant", { seed }).then(response => response.blob()).then(URL.createObjectURL);
      picture.catch(() => this.pictures.delete(key));
      this.pictures.set(key, picture);
    }
    return this.pictures.get(key);
  }

  applies(group, work) {
    if (work.kind === "scene") return group.stage === "write";
    if (work.kind === "library") return group.stage !== "analyze";
    return true;
  }

  showGroups(work) {
    this.of = work.id;
    this.rows.clear();
    const opened = new Set([...this.groups.querySelectorAll("details[open] > summary")].map(summary => summary.textContent));
    const groups = this.table.groups.filter(group => this.applies(group, work)).map(group => {
      const rows = group.knobs.map(knob => this.row(knob, work));
      if (group.title === "Canvas") rows.push(...this.files(work));
      if (CLOSED.has(group.title)) return make("details", { open: opened.has(group.title) }, make("summary", { textContent: group.title }), ...rows);
      return make("div", { className: "group" }, make("h2", { textContent: group.title }), ...rows);
    });
    fill(this.groups, ...groups);
  }

  row(knob, work) {
    const id = `knob-${knob.name}`, value = work.options[knob.name];
    const onset = value => tell("set", { name: knob.name, value });
    const parts = knob.name === "size" ? sizeControl(id, value, work.texture, onset) : undefined;
    const made = row(knob, value, onset, { id, parts });
    this.rows.set(knob.name, made);
    return made;
  }

  /** Brings everything up to date but the control in use. */
  refresh(work) {
    const known = new Map(this.table.groups.flatMap(group => group.knobs).map(knob => [knob.name, knob]));
    for (const [name, old] of this.rows) {
      if (old.contains(document.activeElement)) {
        const set = work.options[name] !== undefined;
        old.classList.toggle("set", set);
        const reset = old.querySelector(".head button");
        if (document.activeElement !== reset) reset.hidden = !set;
        else if (!set) {
          const fresh = this.row(known.get(name), work);
          old.replaceWith(fresh);
          fresh.querySelector("input, select").focus();
        }
        continue;
      }
      const knob = known.get(name);
      old.replaceWith(this.row(knob, work));
    }
  }

  /** Files that steer: a shape to fill, and a map of densities. */
  files(work) {
    const file = (option, title, words, accept, [pen, draw]) => {
      const input = make("input", { type: "file", hidden: true, accept, tabIndex: -1, "aria-label": title });
      input.addEventListener("change", async () => {
        const [chosen] = input.files;
        if (chosen) await tell("side", chosen, { option, name: chosen.name });
        input.value = "";
      });
      const name = work.files[option]?.name;
      const drawing = this.paint.view.pen === pen;
      const take = () => this.paint.take(pen);
      return make("div", { className: name ? "knob set" : "knob" },
        make("div", { className: "head" }, make("span", { className: "label", textContent: title }),
          make("button", { type: "button", textContent: draw, "aria-pressed": String(drawing), disabled: !work.texture, "aria-label": `${title}: ${draw.toLowerCase()} it`, "data-key": `pen-${pen}`, onclick: take }),
          make("button", { type: "button", textContent: "File…", "aria-label": `${title}: choose a file`, "data-key": `file-${option}`, onclick: () => input.click() }),
          name ? make("button", { type: "button", className: "plain", textContent: "Reset", "aria-label": `Reset ${title}`, "data-key": `reset-${option}`, onclick: () => tell("side", new Blob([]), { option }) }) : null),
        input, this.paint.controls(pen), explanation(`${option}-words`, name ? `${name}. ${words}` : words));
    };
    return [
      file("domain", "Shape to fill", "An SVG, whose filled shapes are fitted to the canvas", ".svg,image/svg+xml", ["shape", "Draw"]),
      file("density", "Density", "A grey picture over the canvas: black nothing, middle grey as in the photograph, white twice as dense", "image/*", ["density", "Paint"]),
    ];
  }
}
