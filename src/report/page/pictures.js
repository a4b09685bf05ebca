// Pictures: exemplar, reconstruction and result, each in a window of its own.

const panes = [];

// A pane for each picture that there is.
function makePanes() {
  const stage = byId("stage");
  stage.replaceChildren();
  panes.length = 0;
  const about = group();
  const library = about?.library;
  if (about?.photo) {
    const size = library ?? { width: null, height: null };
    addPane("Exemplar", about.file, size, { photo: about.photo });
  }
  if (library) addPane("Reconstruction", library.name, library, { picture: about.picture });
  if (scene) addPane("Result", scene.name, scene, { picture: "result" });
  panes.forEach((pane) => showPicture(pane).catch(fail));
}

function addPane(title, file, size, source) {
  const holder = el("div", { class: "holder" });
  const pane = { title, width: size.width, height: size.height, holder, drawn: 0, ...source };
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

// Draws the picture of a pane anew, with the layers that are switched on; the old one stays until
// the new one is there.
async function showPicture(pane) {
  const turn = ++pane.drawn;
  let address = null;
  if (pane.photo) {
    address = photoAddress(pane.photo);
  } else {
    const text = await textOf(pane.picture);
    const begin = text.indexOf(">", text.indexOf("<svg")) + 1;
    const style = `<style>${hiddenLayers(pane)}</style>`;
    const parts = [text.slice(0, begin), style, text.slice(begin)];
    address = URL.createObjectURL(new Blob(parts, { type: "image/svg+xml" }));
  }
  const image = await loaded(address);
  if (turn === pane.drawn) {
    pane.width ??= image.naturalWidth;
    pane.height ??= image.naturalHeight;
    image.alt = "";
    image.draggable = false;
    image.style.width = `${pane.width}px`;
    image.style.height = `${pane.height}px`;
    pane.holder.replaceChildren(image);
    pane.image = image;
    if (pane.address) URL.revokeObjectURL(pane.address);
    pane.address = pane.photo ? null : address;
    place();
  } else if (!pane.photo) {
    URL.revokeObjectURL(address);
  }
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
