// Layers to switch on and off, in the reconstruction and in the result.

// Hidden until they are switched on.
const EXTRA = ["ellipses", "motifs", "lattice"];
const hidden = { layers: new Set(EXTRA), categories: new Set() };
const LAYERS = [
  ["background", "Background"],
  ["secondary", "Secondaries"],
  ["primary", "Primaries"],
  ["details", "Details"],
  ["ellipses", "Ellipses"],
  ["motifs", "Motifs"],
  ["lattice", "Rows"],
];

// An SVG taken apart: how it begins, its definitions line by line, and its layers. Layers with names of their own, as those
// of drawings, are with the primaries.
function partsOf(text) {
  const begin = text.indexOf(">", text.indexOf("<svg")) + 1;
  const [from, to] = [text.indexOf("<defs>"), text.indexOf("</defs>")];
  const marks = [...text.matchAll(/<g id="([^"]*)" inkscape:groupmode="layer"/g)];
  // Groups that clip several layers hold nothing else.
  const starts = marks.filter(([, id]) => !/^inside(-\d+)?$/.test(id));
  const layers = {};
  starts.forEach(({ 1: id, index }) => {
    const next = marks.find((mark) => mark.index > index)?.index ?? text.lastIndexOf("</svg>");
    const key = ["background", "secondary"].includes(id) ? id : "primary";
    let layer = text.slice(index, next);
    // What ends a group around several layers is not of this one.
    const count = (mark) => (layer.match(mark) ?? []).length;
    for (let more = count(/<\/g>/g) - count(/<g[ >]/g); more > 0; more--) {
      layer = layer.slice(0, layer.lastIndexOf("</g>"));
    }
    layers[key] = (layers[key] ?? "") + layer;
  });
  return { begin: text.slice(0, begin), definitions: text.slice(from + 6, to).split("\n"), layers };
}

// The Gaussians of primaries: ellipses of two standard deviations with a line along the direction, light in
// dark, so that they are seen on anything.
function ellipsesText(ellipses) {
  const shapes = ellipses.map(([x, y, long, short, angle]) =>
    `<g transform="translate(${x} ${y})rotate(${angle})"><ellipse rx="${long}" ry="${short}"/><path d="M0 0H${long}"/></g>`);
  const drawn = (colour, width) => `<g stroke="${colour}" stroke-width="${width}">${shapes.join("")}</g>`;
  return `<g fill="none" stroke-linecap="round">${drawn("#000b", 2)}${drawn("#fff", 0.8)}</g>`;
}

// The motifs of a drawing: a frame around each, and a dot on each of its elements. Motifs of one kind have one colour.
function motifsText(motifs) {
  const frames = motifs.map(({ kind, parts }) => {
    const ends = (k, more) => parts.map((box) => box[k] + (more ? box[k + 2] : 0));
    const [x0, y0] = [0, 1].map((k) => Math.min(...ends(k, false)) - 1);
    const [x1, y1] = [0, 1].map((k) => Math.max(...ends(k, true)) + 1);
    const dots = parts.map(([x, y, width, height]) => `<circle cx="${x + width / 2}" cy="${y + height / 2}" r="1.5"/>`);
    const colour = `hsl(${(kind * 137.5) % 360} 75% 42%)`;
    return `<g stroke="${colour}" fill="${colour}"><rect x="${x0}" y="${y0}" width="${x1 - x0}" height="${y1 - y0}" `
      + `rx="2" fill-opacity=".08"/>${dots.join("")}</g>`;
  });
  return `<g stroke-width="1">${frames.join("")}</g>`;
}

// The rows or the lattice of an exemplar.
function latticeText(path) {
  const drawn = (colour, width) => `<path d="${path}" stroke="${colour}" stroke-width="${width}"/>`;
  return `<g fill="none">${drawn("#000b", 2.4)}${drawn("#ffd400", 1.2)}</g>`;
}

// One layer as an SVG of its own: with the definitions that it can need, without what is switched off.
function layerText(pane, layer) {
  const { begin, definitions, layers } = pane.parts;
  const own = { secondary: /^s/, primary: /^t/ }[layer] ?? /^$/;
  const needed = definitions.filter((line) => {
    const texton = line.match(/^<(?:path|symbol|linearGradient) id="([st]\d)/);
    return !texton || own.test(texton[1]);
  });
  let content = layers[layer];
  let style = "";
  if (layer === "primary") {
    const instances = pane.picture === "result" ? group()?.instances ?? {} : {};
    const gone = [...hidden.categories].map((id) =>
      instances[id] ? instances[id].map((i) => `#p${i}`).join() : `.category-${id}`);
    style = gone.filter(Boolean).map((which) => `${which}{display:none}`).join("");
    // The first path of a primary, or with a soft rim the first group, is its base; those after it are its details,
    // but for the line along its outline, and the groups of its soft ellipses and of its rim. Definitions and the
    // layers of a shadow are paths beside each other, too.
    if (hidden.layers.has("details")) {
      style += "path~path:where(:not(.outline)),path~g[clip-path],g[fill]~path:where(:not(.outline)),g[fill]~g[clip-path],.rim{display:none}.shadow>path,defs>path,clipPath>path{display:inline}";
    }
  }
  const whole = ["primary", "ellipses"].includes(layer) && scene?.domain === "keep";
  const clips = pane.picture === "result" && scene.domain && !whole;
  if (clips) content = `<g clip-path="url(#domain)">${content}</g>`;
  return `${begin}<style>${style}</style><defs>${needed.join("\n")}</defs>${content}</svg>`;
}

// Shows what a switch has changed: layers are hidden, primaries drawn anew.
function redraw(key) {
  for (const pane of panes) {
    const image = pane.holder.querySelector(`[data-part="${key}"]`);
    if (image) image.hidden = hidden.layers.has(key);
    else if (pane.parts?.layers.primary) showLayer(pane, "primary").catch(fail);
  }
}

function toggle(set, key, button) {
  if (!set.delete(key)) set.add(key);
  button.setAttribute("aria-pressed", String(!set.has(key)));
  redraw(key);
}

function makeLayers() {
  hidden.layers = new Set(EXTRA);
  hidden.categories.clear();
  const box = byId("layers");
  box.replaceChildren();
  if (!panes.some((pane) => pane.picture)) return;
  const found = { motifs: group()?.motifs.length > 0, lattice: Boolean(group()?.library?.lattice?.path) };
  const has = (key) => found[key] ?? true;
  const layers = LAYERS.filter(([key]) => has(key)).map(([key, name]) =>
    el("button", {
      type: "button",
      class: "switch",
      "data-layer": key,
      "aria-pressed": String(!hidden.layers.has(key)),
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
      title: `Category ${category.id}, ${category.name}, ${category.colour}`,
      onclick: (event) => toggle(hidden.categories, category.id, event.currentTarget),
    }, el("i", { class: "dot", style: { background: category.colour } }), String(category.id)));
  const all = (on) => () => {
    hidden.categories.clear();
    if (!on) categories.forEach((category) => hidden.categories.add(category.id));
    buttons.forEach((button) => button.setAttribute("aria-pressed", String(on)));
    redraw("categories");
  };
  box.append(el("div", { class: "row", role: "group", "aria-label": "Categories" },
    el("span", { class: "rowname" }, "Categories"), ...buttons,
    el("button", { type: "button", class: "quiet", onclick: all(true) }, "All"),
    el("button", { type: "button", class: "quiet", onclick: all(false) }, "None")));
}
