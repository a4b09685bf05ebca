// The categories of elements: their names, and which elements are in which.

import { tell } from "./server.js";
import { fill, make } from "./dom.js";
import { hue } from "./canvas.js";

const NEW = "";

/** Whether a category has elements, and all are selected. */
const isWhole = (own, selected) => own.length > 0 && own.every(element => selected.has(element));

export class Categories {
  constructor(view, { onselect }) {
    Object.assign(this, { view, onselect, target: NEW });
    this.panel = make("div");
    this.actions = make("div");
    this.list = make("div");
    fill(this.panel, this.actions, this.list);
  }

  /** The elements of each category. */
  members() {
    const { names, categories } = this.view.elements;
    const members = names.map(() => []);
    categories.forEach((category, element) => members[category]?.push(element));
    return members;
  }

  /** Shows the categories; a name that is being written stays. */
  show(work) {
    this.work = work;
    const { names } = this.view.elements;
    this.panel.hidden = !names.length;
    const active = document.activeElement;
    const writes = this.list.contains(active) && active.type === "text" && active.value !== active.defaultValue;
    this.showActions();
    if (!writes) this.showList();
  }

  showList() {
    const { view } = this;
    const { names } = view.elements;
    const members = this.members();
    const rows = names.map((name, category) => {
      const own = members[category];
      const box = make("input", { type: "checkbox", checked: isWhole(own, view.selected), "aria-label": `Select the elements of ${name}`, title: "Select its elements", "data-key": `category-${category}` });
      box.addEventListener("change", () => {
        for (const element of own) if (box.checked) view.selected.add(element); else view.selected.delete(element);
        this.onselect();
      });
      const dot = make("span", { className: "dot", "aria-hidden": "true" });
      dot.style.background = hue(category);
      const field = make("input", { type: "text", className: "name", defaultValue: name, maxLength: 100, spellcheck: false, autocomplete: "off", "aria-label": `Name of category ${category + 1}`, title: "Write another name to rename it", "data-key": `name-${category}` });
      field.addEventListener("change", async () => {
        const wanted = field.value.trim();
        const isDone = wanted !== name && await this.put(own, wanted);
        if (isDone) field.defaultValue = field.value = wanted; else field.value = name;
      });
      return make("li", {}, box, dot, field, make("span", { className: "count", textContent: own.length }));
    });
    fill(this.list, make("ul", { className: "list" }, ...rows));
  }

  showActions() {
    const { selected, elements } = this.view;
    const { names, categories } = elements;
    const members = this.members();
    const whole = names.filter((_, category) => isWhole(members[category], selected));
    const merge = () => this.put([...selected].filter(element => whole.includes(names[categories[element]])), whole[0]);
    if (this.target !== NEW && !names.includes(this.target)) this.target = NEW;
    const option = (value, textContent) => make("option", { value, textContent, selected: value === this.target });
    const select = make("select", { id: "move-to", disabled: !selected.size, "data-key": "move-to" }, ...names.map(name => option(name, name)), option(NEW, "a new category"));
    select.addEventListener("change", () => { this.target = select.value; });
    const move = () => this.put([...selected], this.target === NEW ? this.newName() : this.target);
    fill(this.actions, make("h2", { textContent: "Categories" }),
      make("div", { className: "knob" }, make("label", { for: "move-to", textContent: "Move selected elements to" }),
        make("div", { className: "control" }, select, make("button", { type: "button", textContent: "Move", disabled: !selected.size, "data-key": "move", onclick: move }))),
      make("div", { className: "row" },
        make("button", { type: "button", textContent: "Merge categories", title: "Check two or more; they take the name of the first", disabled: whole.length < 2, "data-key": "merge-categories", onclick: merge }),
        this.work.elements?.categorized ? make("button", { type: "button", className: "plain", textContent: "Reset categories", title: "Use the categories of the analysis again", "data-key": "find-categories", onclick: () => this.put([], null) }) : null));
  }

  /** A name that no category has. */
  newName() {
    const { names } = this.view.elements;
    for (let number = 1; ; number++) {
      const name = number === 1 ? "new" : `new ${number}`;
      if (!names.includes(name)) return name;
    }
  }

  /** Puts elements into the category of a name; without a name, analysis finds the categories of all. */
  async put(elements, name) {
    return tell("categorize", { version: this.view.elements.version, elements, name });
  }
}
