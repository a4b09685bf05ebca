// Pictures: exemplar, reconstruction and result, each in a window of its own.

const panes = [];

// A pane for each picture that there is.
function makePanes() {
  const stage = byId("stage");
  stage.replaceChildren();
  panes.length = 0;
  const about = group();
  const library = about?.library;
  const lattice = library?.lattice?.path;
  if (about?.photo) {
    const size = library ?? { width: null, height: null };
    addPane("Exemplar", about.file, size, { photo: about.photo, lattice });
  }
  if (library) {
    const { picture, ellipses, motifs } = about;
    addPane("Reconstruction", library.name, library, { picture, ellipses, motifs, lattice });
  }
  if (scene) addPane("Result", scene.name, scene, { picture: "result", ellipses: scene.ellipses });
  panes.forEach((pane) => showPicture(pane).catch(fail));
}

function addPane(title, file, size, source) {
  const holder = el("div", { class: "holder" });
  const pane = { title, width: size.width, height: size.height, holder, ...source };
  const caption = el("figcaption", null, el("b", null, title), " ", el("span", { class: "faint" }, file));
  pane.window = el("div", {
    class: "window",
    tabindex: "0",
    role: "img",
    "aria-label": `${title}: ${file}. Arrow keys move it, plus and minus zoom.`,
  }, holder, el("span", { class: "tag" }, title));
  pane.figure = el("figure", { class: "pane" }, caption, pane.window);
  panes.push(pane);
  byId("stage").append(pane.figure);
  listenToWindow(pane);
}

// Puts its picture into a pane: a photograph, or an image for each layer of an SVG, and what lies over it. As images they
// are moved and stretched smoothly however much they hold, and their ids meet nobody else's.
async function showPicture(pane) {
  if (pane.photo) {
    pane.image = await loaded(photoAddress(pane.photo));
    pane.width ??= pane.image.naturalWidth;
    pane.height ??= pane.image.naturalHeight;
    putInto(pane, pane.image, null);
    const begin = `<svg xmlns="http://www.w3.org/2000/svg" width="${pane.width}" height="${pane.height}">`;
    pane.parts = { begin, definitions: [], layers: {} };
  } else {
    pane.parts = partsOf(await textOf(pane.picture));
    pane.parts.layers.ellipses = ellipsesText(pane.ellipses);
    if (pane.motifs?.length > 0) pane.parts.layers.motifs = motifsText(pane.motifs);
  }
  if (pane.lattice) pane.parts.layers.lattice = latticeText(pane.lattice);
  await Promise.all(Object.keys(pane.parts.layers).map((layer) => showLayer(pane, layer)));
  place();
}

// Draws a layer anew, with what is switched on; the old image stays until the new one is there.
async function showLayer(pane, layer) {
  pane.turns ??= {};
  const turn = pane.turns[layer] = (pane.turns[layer] ?? 0) + 1;
  const svg = new Blob([layerText(pane, layer)], { type: "image/svg+xml" });
  const image = await loaded(URL.createObjectURL(svg));
  if (turn === pane.turns[layer]) putInto(pane, image, layer);
  else URL.revokeObjectURL(image.src);
}

function putInto(pane, image, layer) {
  image.alt = "";
  image.draggable = false;
  image.dataset.part = layer ?? "photo";
  image.hidden = hidden.layers.has(layer);
  image.style.width = `${pane.width}px`;
  image.style.height = `${pane.height}px`;
  pane.holder.style.width = image.style.width;
  pane.holder.style.height = image.style.height;
  const old = pane.holder.querySelector(`[data-part="${image.dataset.part}"]`);
  if (!old) {
    // Layers come in any order and lie in that of painting.
    const order = LAYERS.map(([key]) => key);
    const above = [...pane.holder.children].find((other) =>
      order.indexOf(other.dataset.part) > order.indexOf(layer));
    pane.holder.insertBefore(image, above ?? null);
    return;
  }
  old.replaceWith(image);
  if (layer) URL.revokeObjectURL(old.src);
}

// The picture of a pane as an image that can be drawn, with all layers.
async function imageOf(pane) {
  if (!pane.image) {
    const svg = new Blob([await textOf(pane.picture)], { type: "image/svg+xml" });
    pane.image = await loaded(URL.createObjectURL(svg));
  }
  return pane.image;
}

// Side by side, or two over each other with a slider between them.
const over = { on: false, left: 0, right: 1, share: 0.5 };

function makeSlider() {
  const options = () => panes.map((pane, i) => el("option", { value: i }, pane.title));
  over.left = 0;
  over.right = Math.min(1, panes.length - 1);
  for (const side of ["left", "right"]) {
    const select = byId(side);
    select.replaceChildren(...options());
    select.value = String(over[side]);
  }
  byId("over").disabled = panes.length < 2;
  if (panes.length < 2) over.on = false;
  const handle = el("div", {
    id: "handle",
    class: "handle",
    role: "slider",
    tabindex: "0",
    "aria-label": "Where the left picture ends",
    "aria-valuemin": "0",
    "aria-valuemax": "100",
    onkeydown: (event) => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 };
      if (!(event.key in step)) return;
      event.preventDefault();
      slide(over.share + step[event.key]);
    },
    onpointerdown: (event) => {
      event.preventDefault();
      event.currentTarget.focus();
      event.currentTarget.setPointerCapture(event.pointerId);
    },
    onpointermove: (event) => {
      if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
      const box = byId("stage").getBoundingClientRect();
      slide((event.clientX - box.left) / box.width);
    },
  });
  byId("stage").append(handle);
  arrange();
}

function slide(share) {
  over.share = Math.min(1, Math.max(0, share));
  byId("stage").style.setProperty("--share", `${(100 * over.share).toFixed(2)}%`);
  byId("handle").setAttribute("aria-valuenow", String(Math.round(100 * over.share)));
}

function arrange() {
  byId("stage").classList.toggle("over", over.on);
  byId("beside").setAttribute("aria-pressed", String(!over.on));
  byId("over").setAttribute("aria-pressed", String(over.on));
  byId("pair").hidden = !over.on;
  panes.forEach((pane, i) => {
    pane.figure.classList.toggle("left", over.on && i === over.left);
    pane.figure.classList.toggle("right", over.on && i === over.right && i !== over.left);
    pane.figure.hidden = over.on && i !== over.left && i !== over.right;
  });
  slide(over.share);
  fit();
}

function listenToSlider() {
  byId("beside").addEventListener("click", () => { over.on = false; arrange(); });
  byId("over").addEventListener("click", () => { over.on = true; arrange(); });
  for (const side of ["left", "right"]) {
    byId(side).addEventListener("change", (event) => {
      const other = side === "left" ? "right" : "left";
      const before = over[side];
      over[side] = Number(event.target.value);
      // The same on both sides shows nothing: they change places.
      if (over[side] === over[other]) {
        over[other] = before;
        byId(other).value = String(before);
      }
      arrange();
    });
  }
}
