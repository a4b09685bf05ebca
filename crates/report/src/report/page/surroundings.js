// The descriptor of a primary: the window of the exemplar's arrangement around it, by category.

const labelMaps = new WeakMap();

// Which primary covers each pixel of the exemplar, plus one; 0 is ground.
function labelsOf(library) {
  if (!labelMaps.has(library)) {
    const { width, height, runs } = library.arrangement;
    const labels = new Uint32Array(width * height);
    let at = 0;
    for (let i = 0; i + 1 < runs.length; i += 2) {
      labels.fill(runs[i], at, at + runs[i + 1]);
      at += runs[i + 1];
    }
    labelMaps.set(library, labels);
  }
  return labelMaps.get(library);
}

// Colours as the bytes of a canvas.
function bytesOfColour(css) {
  const canvas = el("canvas", { width: 1, height: 1 });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.fillStyle = css;
  context.fillRect(0, 0, 1, 1);
  return [...context.getImageData(0, 0, 1, 1).data];
}

// The window around a primary, and all textons that stick out of it.
function windowOf(library, texton) {
  const { width, height } = library.arrangement;
  const labels = labelsOf(library);
  const half = library.descriptor_half;
  const [cx, cy] = texton.centre.map(Math.round);
  const wrap = library.parameters.wrap;
  const at = (x, y) => {
    if (wrap) return labels[((y % height) + height) % height * width + ((x % width) + width) % width];
    return x < 0 || y < 0 || x >= width || y >= height ? null : labels[y * width + x];
  };
  const touched = new Set();
  const cells = new Map();
  for (let y = cy - half; y < cy + half; y++) {
    for (let x = cx - half; x < cx + half; x++) {
      const label = at(x, y);
      if (label === null) continue;
      touched.add(label);
      cells.set(label, (cells.get(label) ?? 0) + 1);
    }
  }
  touched.delete(0);
  let [x0, y0, x1, y1] = [cx - half, cy - half, cx + half, cy + half];
  for (const label of touched) {
    // Across a seam the box of a texton says nothing of where its copy stands.
    const [x, y, w, h] = wrap ? [cx, cy, 0, 0] : group().textons[label - 1].bounds;
    [x0, y0] = [Math.min(x0, Math.floor(x)), Math.min(y0, Math.floor(y))];
    [x1, y1] = [Math.max(x1, Math.ceil(x + w)), Math.max(y1, Math.ceil(y + h))];
  }
  return { at, touched, cells, half, centre: [cx, cy], box: [x0, y0, x1, y1] };
}

const PIXELS = 300;

function drawMap(found, texton) {
  const [x0, y0, x1, y1] = found.box;
  const [w, h] = [x1 - x0, y1 - y0];
  const small = el("canvas", { width: w, height: h });
  const context = small.getContext("2d");
  const picture = context.createImageData(w, h);
  const colours = new Map(group().categories.map((c) => [c.id, bytesOfColour(categoryColour(c.id))]));
  const style = getComputedStyle(document.documentElement);
  const empty = bytesOfColour(style.getPropertyValue("--empty"));
  const unknown = bytesOfColour(style.getPropertyValue("--unknown"));
  const own = texton.source + 1;
  const [cx, cy] = found.centre;
  const within = (x, y) => Math.abs(x + 0.5 - cx) < found.half && Math.abs(y + 0.5 - cy) < found.half;
  for (let y = y0; y < y1; y++) {
    for (let x = x0; x < x1; x++) {
      const label = found.at(x, y);
      let colour = null;
      if (label === null) colour = within(x, y) ? unknown : null;
      else if (found.touched.has(label)) colour = colours.get(group().textons[label - 1].category);
      else if (within(x, y)) colour = empty;
      if (!colour) continue;
      const to = 4 * ((y - y0) * w + x - x0);
      picture.data.set(colour, to);
      // Joints between neighbours of one category, and between its pixels and the others.
      const joint = label !== null && label !== 0 && (found.at(x + 1, y) !== label || found.at(x, y + 1) !== label);
      if (joint) for (let k = 0; k < 3; k++) picture.data[to + k] *= 0.75;
      if (label !== own && label) picture.data[to + 3] = 150;
    }
  }
  context.putImageData(picture, 0, 0);
  return drawWindow(found, (large, scale) => {
    large.imageSmoothingEnabled = false;
    large.drawImage(small, 0, 0, w * scale, h * scale);
  });
}

// A canvas of the window, filled by a painter, with the window's frame.
function drawWindow(found, paint) {
  const [x0, y0, x1, y1] = found.box;
  const density = Math.min(3, window.devicePixelRatio || 1);
  const scale = (PIXELS * density) / Math.max(x1 - x0, y1 - y0);
  const canvas = el("canvas", {
    width: Math.max(1, Math.round((x1 - x0) * scale)),
    height: Math.max(1, Math.round((y1 - y0) * scale)),
  });
  const context = canvas.getContext("2d");
  paint(context, scale);
  context.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue("--text");
  context.lineWidth = density;
  context.setLineDash([4 * density, 3 * density]);
  const [cx, cy] = found.centre;
  const side = 2 * found.half * scale - density;
  context.strokeRect((cx - found.half - x0) * scale + density / 2, (cy - found.half - y0) * scale + density / 2, side, side);
  return canvas;
}

// On narrow screens the surroundings come right after the card of their primary.
function placeSurroundings(card) {
  const box = byId("surroundings");
  if (card && matchMedia("(max-width: 980px)").matches) card.after(box);
  else byId("sheet").append(box);
}

function makeSurroundings() {
  state.texton = null;
  placeSurroundings(null);
  const box = byId("surroundings");
  const message = group()?.library
    ? "Choose a primary on the contact sheet. Its descriptor, the categories around it, appears here."
    : "What stands around a primary is known to its library. Give it too: vtex inspect SCENE LIBRARY -o report.html";
  const nothing = (group()?.categories ?? []).length === 0;
  box.hidden = nothing;
  box.replaceChildren(el("h3", { id: "surroundings-head" }, "Surroundings"), el("p", { class: "faint" }, message));
}

function choose(texton, button) {
  document.querySelectorAll('.thumb[aria-pressed="true"]').forEach((b) => b.setAttribute("aria-pressed", "false"));
  button.setAttribute("aria-pressed", "true");
  state.texton = texton;
  placeSurroundings(button.closest(".card"));
  showSurroundings().catch(fail);
}

async function showSurroundings() {
  const texton = state.texton;
  const about = group();
  if (!texton || !about.library || !texton.centre) return;
  const found = windowOf(about.library, texton);
  const box = byId("surroundings");
  const counts = new Map();
  for (const [label, cells] of found.cells) {
    const key = label === 0 ? "ground" : about.textons[label - 1].category;
    const entry = counts.get(key) ?? { cells: 0, textons: 0 };
    counts.set(key, { cells: entry.cells + cells, textons: entry.textons + 1 });
  }
  const all = (2 * found.half) ** 2;
  const known = [...found.cells.values()].reduce((sum, n) => sum + n, 0);
  const line = (colour, name, entry, number) => el("tr", null,
    el("td", null, el("i", { class: "dot", style: { background: colour } }), name),
    el("td", { class: "number" }, number ? integer(entry.textons) : ""),
    el("td", { class: "number" }, percent(entry.cells / all)));
  const rows = [...counts].filter(([key]) => key !== "ground").sort((a, b) => b[1].cells - a[1].cells)
    .map(([key, entry]) => line(categoryColour(key), categoryName(key), entry, true));
  if (counts.has("ground")) rows.push(line("var(--empty)", "Empty", counts.get("ground"), false));
  if (known < all) rows.push(line("var(--unknown)", "Undefined", { cells: all - known }, false));
  const pane = panes.find((each) => each.photo) ?? panes.find((each) => each.title === "Reconstruction");
  const views = el("div", { class: "views" }, el("figure", null, drawMap(found, texton), el("figcaption", null, "By category")));
  if (pane) {
    const image = await imageOf(pane);
    if (texton !== state.texton) return;
    const [x0, y0] = found.box;
    const canvas = drawWindow(found, (context, scale) => {
      const size = [pane.width * scale, pane.height * scale];
      context.drawImage(image, -x0 * scale, -y0 * scale, ...size);
    });
    views.append(el("figure", null, canvas, el("figcaption", null, pane.title)));
  }
  const placed = about.in_scene ? `, placed ${texton.placed}×` : "";
  box.replaceChildren(
    el("h3", { id: "surroundings-head" }, `Around primary ${texton.source}`),
    el("p", { class: "faint" }, `Category ${categoryName(texton.category)}, ${area(texton.area)}${placed}`
      + `${texton.clipped ? ", cut by the border, so never placed" : ""}. Window ${2 * found.half} × ${2 * found.half} px; `
      + "textons that stick out of it belong to the descriptor."),
    views,
    el("table", { class: "plain" },
      el("thead", null, el("tr", null, el("th", null, "In the window"), el("th", { class: "number" }, "textons"), el("th", { class: "number" }, "share"))),
      el("tbody", null, rows)));
}
