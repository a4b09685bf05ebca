// The page: its state comes from the program, and every change goes there.

import { ask, askJson, listen, tell } from "./server.js";
import { fill, find, forget, make, notice, settled } from "./dom.js";
import { View } from "./canvas.js";
import { Steer } from "./knobs.js";
import { Change } from "./change.js";
import { Mend } from "./mend.js";
import { Paint } from "./paint.js";

let state = { open: [] };
let format = "svg", scale = "1", resultFile = "texture.svg";
const shown = { photograph: "", redrawn: "", texture: "", elements: "" };

const table = await askJson("table");
/** The chosen format, as the table has it. */
const chosen = () => table.formats.find(({ name }) => name === format);
const view = new View(find("canvas"), {
  onsharper: () => loadTexture(),
  onzoom: zoom => { find("zoom-one").textContent = `${Math.round(zoom * 100)} %`; },
  onstroke: (tool, path) => view.mode === "texture" ? paint.stroke(tool, path) : mend.stroke(tool, path),
  onpick: (index, more) => mend.pick(index, more),
  onlattice: vectors => mend.followRows(vectors.flat().join(",")),
  onsplit: share => { view.split = share; find("split").value = share * 100; view.draw(); },
});
const paint = new Paint(view, { onview: setView });
const steer = new Steer(find("steer"), table, paint);
const change = new Change(find("change"), table, view);
const mend = new Mend(find("mend"), view, { onview: setView });

/** Fetches the state, one fetch at a time. */
let fetching = false, again = false;
async function refresh() {
  if (fetching) { again = true; return; }
  fetching = true;
  try {
    do {
      again = false;
      state = await askJson("state");
      show();
    } while (again);
  } catch (error) {
    if (error.status) notice(error.message, { hint: error.hint, fault: true, key: "state" });
  } finally { fetching = false; }
}

function show() {
  const { work } = state;
  const open = Boolean(work);
  find("welcome").hidden = open;
  for (const id of ["views", "zoom", "panel", "command"]) find(id).hidden = !open;
  find("open-files").hidden = state.open.length < 2;
  fill(find("open-files"), ...state.open.map(({ id, title }) => make("option", { value: id, textContent: title, selected: id === state.active })));
  find("undo").disabled = !work?.undo;
  find("redo").disabled = !work?.redo;
  showProgress();
  if (!open) return;
  document.title = `${work.name} – vtex studio`;
  showViews(work);
  paint.follow(work);
  const lattice = work.analysis?.lattice;
  view.lattice = lattice && work.kind === "photograph" ? { ...lattice, path: new Path2D(lattice.path) } : null;
  steer.show(work);
  change.show(work);
  mend.show(work);
  showSave(work);
  showMessages(work);
  showCommand();
  loadPictures(work);
}

function ready() {
  const texture = state.work?.texture;
  return Boolean(texture && !texture.draft && !state.busy && !state.rests && !state.fault);
}

/** What tells the texture that there is from others. */
function textureKey() {
  const { work } = state;
  return work?.texture ? `${work.id} ${work.texture.number}` : "";
}

function showProgress() {
  find("cancel").hidden = !state.busy;
  find("resume").hidden = !state.rests;
  find("progress").hidden = !state.busy;
  find("save-now").disabled = !ready() && !state.busy;
  if (state.rests || state.fault) savesWhenReady = false;
  if (savesWhenReady && ready()) save();
  const stage = find("stage");
  const isDrawn = document.body.dataset.drawn === textureKey();
  if (!state.busy) stage.textContent = state.rests ? "Stopped" : state.fault ? "Failed" : !ready() ? "" : isDrawn ? "Ready" : "Drawing…";
  else if (!stage.dataset.busy) stage.textContent = "Working…";
  stage.dataset.busy = state.busy ? "1" : "";
  document.body.dataset.ready = String(ready());
}

/** What was warned about in the last state. */
let warned = [];

function showMessages(work) {
  if (state.fault) notice(state.fault.error, { hint: state.fault.hint, fault: true, key: "fault" });
  else forget("fault");
  if (work.notKept) notice(work.notKept, { fault: true, key: "kept" });
  else forget("kept");
  for (const text of state.warnings.filter(text => !warned.includes(text))) notice(text, { key: text });
  warned = state.warnings;
  if (work.restored && !showMessages.told?.has(work.id)) {
    (showMessages.told ??= new Set()).add(work.id);
    notice(`Settings loaded from ${work.keptIn}`, { hint: "To remove them, choose Start over in the tab Save.", key: "restored" });
  }
}

/** Views that the work has no picture for cannot be chosen. */
function showViews(work) {
  const has = {
    photograph: Boolean(work.size), elements: work.kind === "photograph",
    redrawn: work.kind !== "scene", texture: true, split: work.kind !== "scene",
  };
  for (const input of document.getElementsByName("view")) input.disabled = !has[input.value];
  if (!has[view.mode]) setView("texture");
  find("tiles-label").hidden = view.mode !== "texture";
  find("split-label").hidden = view.mode !== "split";
  const [photograph] = document.querySelectorAll("#views .segments span");
  photograph.textContent = work.kind === "drawing" ? "Drawing" : "Photograph";
}

function setView(mode) {
  for (const input of document.getElementsByName("view")) input.checked = input.value === mode;
  const before = view.content().join();
  view.mode = mode;
  find("tiles-label").hidden = mode !== "texture";
  find("split-label").hidden = mode !== "split";
  if (state.work) loadPictures(state.work);
  if (view.fitted || view.content().join() !== before) view.fit(); else view.draw();
}

async function picture(parameters, signal) {
  const blob = await (await ask("picture", parameters, signal)).blob();
  return createImageBitmap(blob);
}

function loadPictures(work) {
  const of = work.id;
  const wants = mode => view.mode === mode || view.mode === "split";
  if (shown.photograph !== of) {
    shown.photograph = of;
    Object.assign(view, { photograph: null, redrawn: null, texture: null, fitted: true });
    view.selected.clear();
    view.tiles = find("tiles").checked = false;
    if (view.pen) paint.take(view.pen);
    Object.assign(shown, { redrawn: "", texture: "", elements: "" });
    if (work.size) picture({ of: "photograph" }).then(image => { view.photograph = { image, size: work.size }; view.fitted ? view.fit() : view.draw(); }, () => { shown.photograph = ""; });
  }
  const found = `${of} ${work.elements?.version}`;
  const redrawn = JSON.stringify([of, work.analysis?.version, work.options]);
  if (work.analysis && shown.redrawn !== redrawn && (wants("redrawn") && (view.mode === "redrawn" || !work.size))) {
    shown.redrawn = redrawn;
    picture({ of: "redrawn" }).then(image => { view.redrawn = { image, size: [image.width, image.height] }; view.fitted ? view.fit() : view.draw(); }, () => { shown.redrawn = ""; });
  }
  const categories = `${found} ${work.analysis?.version}`;
  if (work.elements && shown.elements !== categories) {
    shown.elements = categories;
    askJson("elements").then(({ version, size, outlines, places, names, categories }) => {
      if (version !== view.elements.version) { view.selected.clear(); view.hovered = -1; }
      view.elements = { version, size, places, paths: outlines.map(path => new Path2D(path)), names, categories };
      mend.show(state.work);
      view.draw();
    }, () => { shown.elements = ""; });
  }
  loadTexture();
}

/** Draws the texture as fine as it is looked at; the newest wish wins. */
let drawing = null;
function loadTexture() {
  const texture = state.work?.texture;
  if (!texture) { view.texture = null; view.draw(); return; }
  // Where it is not looked at, whole pixels are enough.
  const isSeen = view.mode === "texture" || view.mode === "split";
  const zoom = view.zoom * (devicePixelRatio || 1);
  const wanted = isSeen ? zoom : Math.min(zoom, 1);
  const fine = [0.5, 1, 2, 4].find(step => step >= wanted * 0.8) ?? 4;
  const scale = texture.draft ? Math.min(1, fine) : fine;
  const base = textureKey();
  const key = `${base} ${scale}`;
  if (shown.texture === key || (view.texture?.key === base && view.texture.scale >= scale)) return;
  shown.texture = key;
  drawing?.abort();
  drawing = new AbortController();
  picture({ of: "texture", number: texture.number, scale }, drawing.signal).then(image => {
    const size = [texture.width, texture.height];
    // Around a draft stands the last whole texture, if it has the same size.
    const { texture: last } = view;
    const around = texture.draft && last?.whole.join() === texture.whole.join() ? last.draft ? last.around : last.image : null;
    view.texture = { image, size, whole: texture.whole, draft: texture.draft, around, scale, key: base };
    document.body.dataset.drawn = base;
    showProgress();
    if (view.fitted) view.fit(); else view.draw();
  }, error => { if (error.name !== "AbortError") shown.texture = ""; });
}

function showSave(work) {
  const panel = find("save");
  if (!panel.firstChild) {
    const formats = table.formats.map(({ name: value, title, words }) => {
      const input = make("input", { type: "radio", name: "format", value, checked: value === format });
      input.addEventListener("change", () => { format = value; showSave(state.work); showCommand(); });
      return make("label", {}, input, make("span", { textContent: title }, make("small", { textContent: words })));
    });
    const size = make("input", { type: "number", id: "scale", min: 0.05, max: 20, step: "any", value: scale });
    size.addEventListener("change", () => { scale = size.value || "1"; showCommand(); });
    fill(panel, make("h2", { textContent: "Save" }),
      make("div", { className: "formats", role: "radiogroup", "aria-label": "Format" }, ...formats),
      make("div", { className: "knob", id: "scale-row" }, make("div", { className: "head" }, make("label", { for: "scale", textContent: "Scale (2: twice as wide and high)" })), make("div", { className: "control" }, size)),
      make("button", { type: "button", className: "primary save-button", id: "save-file", onclick: save }),
      make("p", { id: "weight", role: "status", "aria-live": "polite" }),
      make("h2", { textContent: "Saved settings" }), make("p", { id: "kept" }),
      make("div", { className: "row" }, make("button", { type: "button", textContent: "Start over", title: "Remove all settings and changes; undo brings them back", onclick: () => tell("anew") })));
  }
  find("save-now").textContent = `Save ${chosen().title}`;
  find("scale-row").hidden = !chosen().scaled;
  const possible = value => value === "library" ? Boolean(work.analysis) && work.kind !== "library" : true;
  for (const input of document.getElementsByName("format")) input.disabled = !possible(input.value);
  if (!possible(format)) { format = "svg"; document.querySelector("[name=format][value=svg]").checked = true; }
  find("save-file").disabled = !ready() && !state.busy;
  find("kept").textContent = work.notKept ?? `Settings are stored in ${work.keptIn}${work.mended ? ` and ${work.mended}` : ""}. To continue later, open ${work.name} again.`;
}

/** Bytes above which programs that edit vectors become slow, and what helps. */
const HEAVY = 10e6;
const LIGHTER = "Many programs open so large a file slowly: a smaller canvas, fewer elements or PNG make it lighter.";

const readable = bytes => bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;

/** Says before saving how large the file will be, while it can be seen. */
let weighing = null, weighed = "";
const showWeight = settled(async () => {
  const place = find("weight");
  if (!place || find("save").hidden || !ready()) return;
  const parameters = { format, scale: chosen().scaled ? scale : "" };
  const key = JSON.stringify([textureKey(), state.version, parameters]);
  if (weighed === key) return;
  weighed = key;
  weighing?.abort();
  weighing = new AbortController();
  place.className = "";
  place.textContent = "Measuring the file…";
  try {
    const { bytes, size } = await (await ask("weigh", parameters, weighing.signal)).json();
    const pixels = chosen().scaled ? `${size[0]} × ${size[1]} px` : "";
    const heavy = bytes > HEAVY && !chosen().scaled;
    place.className = heavy ? "heavy" : "";
    place.textContent = [pixels, bytes === null ? "" : readable(bytes)].filter(Boolean).join(", ") + (heavy ? `. ${LIGHTER}` : "");
  } catch (error) {
    if (error.name === "AbortError") return;
    weighed = "";
    place.className = "heavy";
    place.textContent = error.hint ? `${error.message}; ${error.hint}` : error.message;
  }
}, 200);

const showCommand = settled(async () => {
  if (!state.work) return;
  showWeight();
  try {
    const { lines, file } = await askJson("commands", { format, scale: chosen().scaled ? scale : "" });
    find("lines").textContent = lines.join("\n");
    resultFile = file ?? resultFile;
    const button = find("save-file");
    if (button) button.textContent = `Save ${resultFile}`;
  } catch { /* The next state brings another. */ }
}, 60);

/** Whether Save was pressed while the texture was made, as happens after a number was typed. */
let savesWhenReady = false;

async function save() {
  savesWhenReady = !ready();
  if (savesWhenReady) return;
  try {
    const response = await ask("save", { format, scale: chosen().scaled ? scale : "" });
    const address = URL.createObjectURL(await response.blob());
    make("a", { href: address, download: resultFile }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  } catch (error) { notice(error.message, { hint: error.hint, fault: true, key: "refused" }); }
}

async function copy() {
  const text = find("lines").textContent;
  try { await navigator.clipboard.writeText(text); } catch {
    getSelection().selectAllChildren(find("lines"));
    document.execCommand("copy");
    getSelection().removeAllRanges();
  }
  find("copy").textContent = "Copied";
  setTimeout(() => { find("copy").textContent = "Copy"; }, 1500);
}

async function openFiles(files) {
  for (const file of files) {
    find("stage").textContent = `Opening ${file.name}…`;
    if (await tell("open", file, { name: file.name })) forget("refused");
  }
}

function selectTab(name, focus = false) {
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const own = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", String(own));
    tab.tabIndex = own ? 0 : -1;
    find(tab.getAttribute("aria-controls")).hidden = !own;
    if (own && focus) tab.focus();
  }
  if (name !== "steer" && view.pen) paint.take(view.pen);
  if (name === "save") showWeight();
  if (name === "mend" && state.work?.kind === "photograph") setView("elements");
  else if (name !== "mend" && view.mode === "elements") setView("texture");
}

// What is clicked, dropped and typed.
for (const tab of document.querySelectorAll("[role=tab]")) {
  tab.addEventListener("click", () => selectTab(tab.id.slice(4)));
  tab.addEventListener("keydown", event => {
    const all = [...document.querySelectorAll("[role=tab]")];
    const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (way) selectTab(all[(all.indexOf(tab) + way + all.length) % all.length].id.slice(4), true);
  });
}
for (const id of ["open", "open-first"]) find(id).addEventListener("click", () => find("file").click());
find("file").multiple = true;
find("file").addEventListener("change", async event => { await openFiles([...event.target.files]); event.target.value = ""; });
find("open-files").addEventListener("change", event => tell("choose", Number(event.target.value)));
find("cancel").addEventListener("click", () => tell("cancel"));
find("resume").addEventListener("click", () => tell("resume"));
find("undo").addEventListener("click", () => tell("undo"));
find("redo").addEventListener("click", () => tell("redo"));
find("save-now").addEventListener("click", save);
find("copy").addEventListener("click", copy);
find("zoom-in").addEventListener("click", () => view.scale(1.25));
find("zoom-out").addEventListener("click", () => view.scale(0.8));
find("zoom-one").addEventListener("click", () => view.scale(1 / view.zoom));
find("zoom-fit").addEventListener("click", () => view.fit());
find("tiles").addEventListener("change", event => {
  view.tiles = event.target.checked;
  view.fit();
  const tiles = state.work?.texture?.tiles ?? [];
  if (view.tiles && !tiles.every(Boolean)) notice("Copies of this texture meet in a seam.", { hint: state.work.kind === "scene" ? undefined : "Set Tile to both, under Steer, for a texture that repeats.", key: "seam" });
  else forget("seam");
});
find("split").addEventListener("input", event => { view.split = event.target.value / 100; view.draw(); });
for (const input of document.getElementsByName("view")) input.addEventListener("change", () => setView(input.value));

let dragged = 0;
addEventListener("dragenter", event => { event.preventDefault(); dragged++; find("drop").hidden = false; });
addEventListener("dragleave", () => { dragged = Math.max(0, dragged - 1); find("drop").hidden = dragged === 0; });
addEventListener("dragover", event => event.preventDefault());
addEventListener("drop", event => {
  event.preventDefault();
  dragged = 0;
  find("drop").hidden = true;
  openFiles([...event.dataTransfer.files]);
});

addEventListener("keydown", event => {
  const typing = event.target.matches("input:not([type=checkbox]):not([type=radio]):not([type=range]), select, textarea");
  const command = event.ctrlKey || event.metaKey;
  const key = event.key.toLowerCase();
  if (command && key === "z" && !typing) tell(event.shiftKey ? "redo" : "undo");
  else if (command && key === "y" && !typing) tell("redo");
  else if (command && key === "s") { if (state.work) save(); }
  else if (command && key === "o") find("file").click();
  else if (!command && !typing && !event.altKey && key === "d" && state.work && state.work.kind !== "scene") tell("seed", { seed: null });
  else if (!command && !typing && key === "escape" && view.selected.size) mend.pick(-1, false);
  else if (!command && !typing && view.mode === "elements" && mend.key(event)) { /* It was done. */ }
  else return;
  event.preventDefault();
});

listen({
  changed: refresh,
  progress: ({ stage, done, total }) => {
    if (!state.busy) return;
    find("stage").textContent = `${stage[0].toUpperCase()}${stage.slice(1)}…`;
    const bar = find("progress");
    if (total > 0) bar.value = done / total; else bar.removeAttribute("value");
  },
  connected: here => {
    if (here) forget("connection");
    else notice("vtex does not respond.", { hint: "If it has ended, start 'vtex studio' again: your work is saved.", fault: true, key: "connection" });
  },
});
