// The tab Mend: the elements of a photograph, put right by hand.

import { tell } from "./server.js";
import { Categories } from "./categories.js";
import { fill, make } from "./dom.js";

const TOOLS = [
  ["select", "Select", "Click an element; hold Shift to select several, or tap one after the other. Keys: N and P go to the next and the previous one, Enter selects it."],
  ["erase", "Erase", "What the brush touches becomes background."],
  ["lasso", "Draw element", "Draw the outline of an element."],
  ["cut", "Cut", "Select an element and draw a line right across it."],
];

export class Mend {
  constructor(panel, view, { onview }) {
    Object.assign(this, { panel, view, onview });
    this.view.tool = "select";
    this.tools = make("div");
    this.actions = make("div");
    this.rows = make("div");
    this.none = make("p", { textContent: "Only the elements of a photograph can be mended: those of drawings, libraries and scenes are as they were drawn or found." });
    this.categories = new Categories(view, { onselect: () => { this.showActions(); this.view.draw(); } });
    fill(panel, this.none, this.tools, this.actions, this.rows, this.categories.panel);
    this.showTools();
  }

  show(work) {
    this.work = work;
    const possible = work.kind === "photograph" && work.elements;
    this.none.hidden = work.kind === "photograph";
    this.tools.hidden = this.actions.hidden = !possible;
    this.showRows(work);
    this.showActions();
    if (!possible) this.categories.panel.hidden = true;
  }

  showTools() {
    const tool = this.view.tool;
    const buttons = TOOLS.map(([name, title]) => make("button", {
      type: "button", textContent: title, "aria-pressed": String(name === tool), "data-key": `tool-${name}`,
      onclick: () => { this.view.tool = name; this.view.stroke = []; this.onview("elements"); this.showTools(); this.view.draw(); },
    }));
    const brush = make("input", { type: "range", min: 1, max: 60, value: this.view.brush, id: "brush", "data-key": "brush" });
    brush.addEventListener("input", () => { this.view.brush = Number(brush.value); this.view.draw(); });
    const keys = tool === "select" ? "" : " Keys: arrows move it, the space bar begins and ends.";
    fill(this.tools, make("h2", { textContent: "Tool" }), make("div", { className: "tools" }, ...buttons),
      make("p", { textContent: TOOLS.find(([name]) => name === tool)[2] + keys }),
      tool === "erase" ? make("div", { className: "knob" }, make("label", { for: "brush", textContent: "Radius of the brush" }), brush) : null);
  }

  /** The rows or the lattice that textures keep, which can be switched off or dragged. */
  showRows(work) {
    const lattice = work.kind === "photograph" ? work.analysis?.lattice : null;
    if (!lattice) return fill(this.rows);
    const { words, followed, found } = lattice;
    const keep = make("input", { type: "checkbox", checked: followed, id: "keep-rows", "data-key": "keep-rows" });
    // Found rows that are kept by default need no option.
    const vectors = found?.kept ? null : (found?.vectors ?? lattice.vectors).flat().map(v => v.toFixed(1)).join(",");
    keep.addEventListener("change", () => this.followRows(keep.checked ? vectors : found?.kept === false ? null : "off"));
    const isChanged = work.options.lattice !== undefined && work.options.lattice !== "off";
    fill(this.rows, make("h2", { textContent: "Rows" }),
      make("div", { className: "knob" },
        make("div", { className: "head" }, make("label", { for: "keep-rows", textContent: `Keep ${words}` }), keep,
          make("button", { type: "button", className: "plain", textContent: "Reset", "aria-label": "Reset rows", hidden: !isChanged, "data-key": "reset-rows", onclick: () => this.followRows(null) })),
        make("p", { className: "words", textContent: "Drag the heads of the pink arrows to change the period." })));
  }

  /** Sets the lattice that textures follow, as on the command line; null is the one found. */
  followRows(value) {
    this.onview("elements");
    tell("set", { name: "lattice", value });
  }

  showActions() {
    const { selected } = this.view;
    const work = this.work;
    const action = (title, key, least, mending, hint) => make("button", {
      type: "button", textContent: title, title: hint, disabled: selected.size < least, "data-key": key,
      onclick: () => this.mend(mending([...selected])),
    });
    fill(this.actions, make("h2", { textContent: selected.size === 1 ? "1 element selected" : `${selected.size} elements selected` }),
      make("div", { className: "tools" },
        action("Delete", "delete", 1, elements => ({ do: "delete", elements }), "Delete"),
        action("Merge", "merge", 2, elements => ({ do: "merge", elements }), "M"),
        action("Grow", "grow", 1, elements => ({ do: "grow", elements, by: 1 }), "By a pixel"),
        action("Shrink", "shrink", 1, elements => ({ do: "grow", elements, by: -1 }), "By a pixel")),
      make("p", { className: "facts" }, make("span", {}, make("b", { textContent: work?.elements?.count ?? 0 }), " elements"),
        make("span", { textContent: work?.mended ? `kept in ${work.mended}` : "as they were found" })));
    if (work) this.categories.show(work);
  }

  /** A click on an element, or on none. */
  pick(index, more) {
    const { selected } = this.view;
    if (index < 0) selected.clear();
    else if (more && selected.has(index)) selected.delete(index);
    else {
      if (!more) selected.clear();
      selected.add(index);
    }
    this.showActions();
    this.view.draw();
  }

  stroke(tool, path) {
    const thinned = path.filter((point, index) => index === 0 || index === path.length - 1 || index % Math.ceil(path.length / 4000) === 0);
    if (tool === "erase") return this.mend({ do: "erase", path: thinned, radius: this.view.brush });
    if (tool === "lasso") return this.mend({ do: "draw", path: thinned });
    const [element] = this.view.selected.size === 1 ? this.view.selected : [this.crossed(thinned)];
    return this.mend({ do: "split", element: Math.max(0, element), path: thinned });
  }

  /** The element that a line crosses most. */
  crossed(path) {
    const counts = new Map();
    for (const [a, b] of path.slice(1).map((point, index) => [path[index], point])) {
      for (let k = 0; k < 8; k++) {
        const at = this.view.elementAt([0, 1].map(i => a[i] + (b[i] - a[i]) * k / 8));
        if (at >= 0) counts.set(at, (counts.get(at) ?? 0) + 1);
      }
    }
    return [...counts].sort((a, b) => b[1] - a[1])[0]?.[0] ?? -1;
  }

  async mend(mending) {
    if (await tell("mend", { version: this.view.elements.version, mending })) this.view.selected.clear();
    this.showActions();
  }

  key(event) {
    const { selected } = this.view;
    if ((event.key === "Delete" || event.key === "Backspace") && selected.size) this.mend({ do: "delete", elements: [...selected] });
    else if (event.key === "m" && selected.size > 1) this.mend({ do: "merge", elements: [...selected] });
    else return false;
    return true;
  }
}
