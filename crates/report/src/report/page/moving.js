// Zoom and movement, the same for all pictures. A pixel of one picture is as large as one of any
// other; the point looked at is counted from the middle of each.

const look = { scale: 1, x: 0, y: 0 };
const SMALLEST = 0.02;
const LARGEST = 64;

const seen = () => panes.filter((pane) => !pane.figure.hidden && pane.width);

// How far the middle of the window may be from that of the picture, along an axis.
const room = (picture, frame) => Math.max(0, (picture - frame / look.scale) / 2);

// Puts every picture where it is looked at.
function place() {
  const visible = seen();
  const limit = (side, frame) =>
    Math.max(0, ...visible.map((pane) => room(pane[side], pane.window[frame])));
  const [mostX, mostY] = [limit("width", "clientWidth"), limit("height", "clientHeight")];
  look.x = Math.min(mostX, Math.max(-mostX, look.x));
  look.y = Math.min(mostY, Math.max(-mostY, look.y));
  for (const pane of visible) {
    const [w, h] = [pane.window.clientWidth, pane.window.clientHeight];
    // Two that lie over each other must not slip.
    const [rx, ry] = over.on ? [mostX, mostY] : [room(pane.width, w), room(pane.height, h)];
    const x = Math.min(rx, Math.max(-rx, look.x));
    const y = Math.min(ry, Math.max(-ry, look.y));
    const left = w / 2 - (pane.width / 2 + x) * look.scale;
    const top = h / 2 - (pane.height / 2 + y) * look.scale;
    pane.holder.style.transform = `translate(${left}px, ${top}px) scale(${look.scale})`;
    pane.holder.classList.toggle("pixels", Boolean(pane.photo) && look.scale >= 3);
  }
  byId("scale").value = `${short(100 * look.scale).slice(0, 5)}\u202f%`;
}

// While pictures move they are not drawn anew, only stretched; once they rest they are sharp again.
let resting = 0;
function moving() {
  panes.forEach((pane) => pane.holder.classList.add("moving"));
  clearTimeout(resting);
  resting = setTimeout(() => panes.forEach((pane) => pane.holder.classList.remove("moving")), 180);
}

// Zooms so that what lies under a point of a window, counted from its middle, stays there.
function zoom(factor, dx = 0, dy = 0) {
  const before = look.scale;
  look.scale = Math.min(LARGEST, Math.max(SMALLEST, before * factor));
  look.x += dx / before - dx / look.scale;
  look.y += dy / before - dy / look.scale;
  moving();
  place();
}

function move(dx, dy) {
  look.x -= dx / look.scale;
  look.y -= dy / look.scale;
  moving();
  place();
}

// All of the largest picture, as long as the smallest still fills half of its window.
function fit() {
  const scales = seen().map((pane) =>
    Math.min(pane.window.clientWidth / pane.width, pane.window.clientHeight / pane.height));
  if (scales.length > 0) {
    look.scale = Math.max(Math.min(...scales), Math.max(...scales) / 2);
    look.scale = Math.min(LARGEST, Math.max(SMALLEST, look.scale));
  }
  [look.x, look.y] = [0, 0];
  place();
}

function fromMiddle(pane, event) {
  const box = pane.window.getBoundingClientRect();
  return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
}

function listenToWindow(pane) {
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) || 1;
  };
  const listen = (name, listener) => pane.window.addEventListener(name, listener, { passive: false });
  listen("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.002)), ...fromMiddle(pane, event));
  });
  listen("dblclick", (event) => zoom(event.shiftKey ? 0.5 : 2, ...fromMiddle(pane, event)));
  listen("pointerdown", (event) => {
    if (event.button !== 0) return;
    pane.window.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  listen("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const apart = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, event);
    if (fingers.size === 2) zoom(spread() / apart, ...fromMiddle(pane, event));
    else move(event.clientX - before.clientX, event.clientY - before.clientY);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
    listen(name, (event) => fingers.delete(event.pointerId));
  }
  listen("keydown", (event) => {
    const step = 60;
    const keys = {
      ArrowLeft: () => move(step, 0),
      ArrowRight: () => move(-step, 0),
      ArrowUp: () => move(0, step),
      ArrowDown: () => move(0, -step),
      "+": () => zoom(1.25),
      "=": () => zoom(1.25),
      "-": () => zoom(0.8),
      0: fit,
      1: () => zoom(1 / look.scale),
    };
    if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}

function listenToZoom() {
  byId("in").addEventListener("click", () => zoom(1.25));
  byId("out").addEventListener("click", () => zoom(0.8));
  byId("fit").addEventListener("click", fit);
  byId("one").addEventListener("click", () => zoom(1 / look.scale));
  let width = 0;
  new ResizeObserver(() => {
    // A scroll bar that comes and goes is no reason to lose the place.
    const now = byId("stage").clientWidth;
    if (Math.abs(now - width) > 40) fit();
    else place();
    width = now;
  }).observe(byId("stage"));
}
