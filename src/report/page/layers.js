// Layers to switch on and off, in the reconstruction and in the result.

const hidden = { layers: new Set(), categories: new Set() };
const LAYERS = [
  ["background", "Background"],
  ["secondary", "Secondaries"],
  ["primary", "Primaries"],
  ["details", "Details"],
];

// The style sheet that a picture is given: what of it is not shown.
function hiddenLayers(pane) {
  const rules = [];
  for (const layer of hidden.layers) {
    if (layer !== "details") {
      rules.push(`#${layer}{display:none}`);
      continue;
    }
    // The first path of a primary is its base, those after it are its details. Definitions and
    // secondaries are paths beside each other, too.
    rules.push("path~path{display:none}");
    rules.push("#secondary path,defs>path,clipPath>path{display:inline}");
  }
  const instances = pane.picture === "result" ? group()?.instances ?? {} : {};
  for (const id of hidden.categories) {
    const listed = instances[id];
    const which = listed ? listed.map((i) => `#p${i}`).join() : `[data-category="${id}"]`;
    if (which) rules.push(`${which}{display:none}`);
  }
  return rules.join("");
}

function redraw() {
  for (const pane of panes) {
    if (pane.picture) showPicture(pane).catch(fail);
  }
}

function toggle(set, key, button) {
  if (!set.delete(key)) set.add(key);
  button.setAttribute("aria-pressed", String(!set.has(key)));
  redraw();
}

function makeLayers() {
  hidden.layers.clear();
  hidden.categories.clear();
  const box = byId("layers");
  box.replaceChildren();
  if (!panes.some((pane) => pane.picture)) return;
  const layers = LAYERS.map(([key, name]) =>
    el("button", {
      type: "button",
      class: "switch",
      "data-layer": key,
      "aria-pressed": "true",
      onclick: (event) => toggle(hidden.layers, key, event.currentTarget),
    }, name));
  box.append(el("div", { class: "row", role: "group", "aria-label": "Layers" },
    el("span", { class: "rowname" }, "Layers"), ...layers));
  const categories = group()?.categories ?? [];
  if (categories.length === 0) return;
  const buttons = categories.map((category) =>
    el("button", {
      type: "button",
      class: "switch",
      "data-category": category.id,
      "aria-pressed": "true",
      title: `Category ${category.id}, ${category.colour}`,
      onclick: (event) => toggle(hidden.categories, category.id, event.currentTarget),
    }, el("i", { class: "dot", style: { background: category.colour } }), String(category.id)));
  const all = (on) => () => {
    hidden.categories.clear();
    if (!on) categories.forEach((category) => hidden.categories.add(category.id));
    buttons.forEach((button) => button.setAttribute("aria-pressed", String(on)));
    redraw();
  };
  box.append(el("div", { class: "row", role: "group", "aria-label": "Categories" },
    el("span", { class: "rowname" }, "Categories"), ...buttons,
    el("button", { type: "button", class: "quiet", onclick: all(true) }, "All"),
    el("button", { type: "button", class: "quiet", onclick: all(false) }, "None")));
}
