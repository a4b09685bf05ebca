// The background's colours, parameters, and what the user should know.

// Lightness of a colour as it is seen, roughly.
function lightness(hex) {
  const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  return 0.3 * r + 0.59 * g + 0.11 * b;
}

function makePalette(title, background, size) {
  const { points, fallback, spacing } = background;
  const sorted = points.map((p) => p[2]).sort((a, b) => lightness(a) - lightness(b) || (a < b ? -1 : 1));
  const few = sorted.length <= 400
    ? sorted : Array.from({ length: 400 }, (_, i) => sorted[Math.floor((i * sorted.length) / 400)]);
  const strip = el("div", { class: "strip", role: "img", "aria-label": `${points.length} colours from dark to light` },
    few.map((colour) => el("i", { style: { background: colour }, title: colour })));
  const radius = Math.max(1, spacing * 0.32);
  const inside = points.filter(([x, y]) => x >= 0 && y >= 0 && x <= size.width && y <= size.height);
  const dots = inside.slice(0, 4000).map(([x, y, colour]) =>
    vector("circle", { cx: x, cy: y, r: radius, fill: colour }));
  const map = vector("svg", {
    class: "sites",
    viewBox: `0 0 ${size.width} ${size.height}`,
    role: "img",
    "aria-label": "Where the colours stand",
  }, ...dots);
  return el("article", { class: "palette" },
    el("h3", null, title),
    el("p", { class: "faint" }, `${plural(points.length, "colour", "colours")}, ${short(spacing)} px apart; `,
      el("i", { class: "dot", style: { background: fallback } }), ` ${fallback} where nothing better is known`),
    strip, map);
}

function makeBackground() {
  const library = group()?.library;
  const palettes = [];
  if (library) palettes.push(makePalette("Palette of the exemplar", library.background, library));
  if (scene) palettes.push(makePalette("Background of the result", scene.background, scene));
  byId("palettes").replaceChildren(...palettes);
  byId("background-lead").textContent =
    "The smooth background beneath all elements: a field of colours through these points, sorted from dark to light, and where they stand.";
}

// An object as rows of a table, those that differ from the defaults marked.
function rowsOf(values, defaults, prefix = "") {
  return Object.entries(values).flatMap(([key, value]) => {
    const name = prefix + key.replaceAll("_", "-");
    const usual = defaults?.[key];
    if (value !== null && typeof value === "object" && !Array.isArray(value)) {
      return rowsOf(value, usual, `${name}: `);
    }
    const changed = usual !== undefined && JSON.stringify(value) !== JSON.stringify(usual);
    const shown = value === null || (Array.isArray(value) && value.length === 0) ? "–" : [value].flat().join(", ");
    return [el("tr", { class: changed ? "changed" : null },
      el("th", { scope: "row" }, name),
      el("td", null, shown, changed ? el("span", { class: "faint" }, ` (default ${JSON.stringify(usual)})`) : null))];
  });
}

function table(title, ...rows) {
  return el("article", { class: "fact" }, el("h3", null, title),
    el("table", { class: "plain" }, el("tbody", null, ...rows)));
}

const row = (name, value) =>
  value === null || value === undefined ? null
    : el("tr", null, el("th", { scope: "row" }, name), el("td", null, value));

function makeFacts() {
  const about = group();
  const library = about?.library;
  const box = byId("facts");
  box.replaceChildren();
  if (library) {
    const { seed: _, ...parameters } = library.parameters;
    box.append(
      table("Library", row("file", library.name), row("photograph", about.file),
        row("SHA-256", el("code", null, about.sha256)), row("size", `${library.width} × ${library.height} px`),
        row("segmenter", library.segmenter), row("seed", library.seed), row("written by", library.program),
        row("primaries", `${integer(library.primaries)}, ${integer(library.clipped)} of them cut by the border`),
        about.motifs.length > 0 ? row("motifs", integer(about.motifs.length)) : null,
        library.lattice ? row("regular", `${library.lattice.words}${library.lattice.kept ? "" : ", in parts only"}`) : null,
        row("details", integer(library.details)),
        row("secondaries", `${integer(library.secondaries)}, ${short(library.secondary_spacing)} px apart`),
        row("coverage", percent(library.coverage))),
      table("Analysis", ...rowsOf(parameters, library.defaults)));
  }
  if (scene) {
    const { seed: _, ...parameters } = scene.parameters ?? {};
    const tile = scene.tile;
    box.append(
      table("Scene", row("file", scene.name), row("made from", scene.exemplars.join(", ")),
        row("size", `${scene.width} × ${scene.height} px`),
        row("repeats", tile.x && tile.y ? "along both axes" : tile.x ? "left to right" : tile.y ? "top to bottom" : "no"),
        row("fills", scene.domain ? "a shape" : "the canvas"),
        row("seed", scene.seed ?? "none, nothing was drawn by chance"), row("written by", scene.program),
        row("primaries", integer(scene.primaries)), row("details", integer(scene.details)),
        row("secondaries", integer(scene.secondaries)), row("coverage", percent(scene.coverage))));
    if (scene.parameters) box.append(table("Synthesis", ...rowsOf(parameters, scene.defaults)));
    if (scene.edits.length > 0) box.append(makeEdits());
  }
  box.append(table("This page", row("written by", data.program)));
}

// What was done to the scene after synthesis, in order.
function makeEdits() {
  const items = scene.edits.map((edit) =>
    el("li", null, el("code", null, edit.operation), el("span", { class: "faint" }, ` seed ${edit.seed}`)));
  return el("article", { class: "fact" }, el("h3", null, "Edits"),
    el("p", { class: "faint" }, "What was done to the scene after it was made, one after another."),
    el("ol", { class: "edits" }, ...items));
}

function makeNotes() {
  const about = group();
  const notes = [];
  if (about?.photo_missing) notes.push(["", about.photo_missing]);
  if (scene && about?.library && !about.in_scene) {
    notes.push(["", `The scene ${scene.name} was not made from this library, so the two are not compared.`]);
  }
  for (const warning of about?.library?.warnings ?? []) notes.push(["Warning: ", warning]);
  byId("notes").replaceChildren(...notes.map(([head, text]) =>
    el("p", { class: head ? "note warning" : "note" }, head ? el("b", null, head) : null, text)));
}

function makeSummary() {
  const parts = [];
  const library = group()?.library;
  if (library) {
    parts.push(`library: ${library.width} × ${library.height} px, ${plural(library.primaries, "primary", "primaries")} `
      + `in ${plural(group().categories.length, "category", "categories")}`);
  }
  if (scene) {
    parts.push(`result: ${scene.width} × ${scene.height} px, ${plural(scene.primaries, "primary", "primaries")}`);
    if (scene.seed !== null) parts.push(`seed ${scene.seed}`);
    if (scene.edits.length > 0) parts.push(plural(scene.edits.length, "edit", "edits"));
  }
  byId("summary").textContent = parts.join(" · ");
}
