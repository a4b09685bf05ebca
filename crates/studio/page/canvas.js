// The picture: what is seen, at which zoom, and what pointer and keys do on it.

import { settled } from "./dom.js";

const LEAST = 0.02, MOST = 40, MARGIN = 28;
/** Room for the buttons over and under the picture; beside it is room for the latter on wide pages. */
const ABOVE = 44, BELOW = 40, WIDE = 900;
const REACH = 4;

const clamp = (value, least, most) => Math.min(most, Math.max(least, value));
/** The colour of a category. */
export const hue = index => `hsl(${(index * 137.5 + 160) % 360} 78% 58%)`;

/** The canvas with its view. It tells `onsharper` when the texture should be drawn finer. */
export class View {
  photograph = null;
  redrawn = null;
  texture = null;
  /** Outlines of elements, in pixels of the photograph. */
  elements = { size: [1, 1], paths: [], places: [], names: [], categories: [] };
  /** Rows or lattice of the photograph: its vectors, the borders of its cells, and whether textures follow it. */
  lattice = null;
  selected = new Set();
  hovered = -1;
  tool = null;
  stroke = [];
  brush = 6;
  /** What draws on the texture: "density", "shape" or nothing. */
  pen = null;
  radius = 40;
  /** What takes the colour that is pressed next, if anything does. */
  pipette = null;
  /** The map of densities, over the whole canvas. */
  map = null;
  mode = "texture";
  tiles = false;
  split = 0.5;
  cursor = null;

  constructor(canvas, { onsharper, onzoom, onstroke, onpick, onsplit, onlattice }) {
    Object.assign(this, { canvas, onstroke, onpick, onzoom, onsplit, onlattice });
    this.context = canvas.getContext("2d");
    this.zoom = 1;
    this.x = 0;
    this.y = 0;
    this.fitted = true;
    this.pointers = new Map();
    this.sharper = settled(onsharper, 250);
    new ResizeObserver(() => this.resize()).observe(canvas);
    for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel", "pointerleave"]) {
      canvas.addEventListener(name, event => this[name](event));
    }
    canvas.addEventListener("wheel", event => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", event => this.keydown(event));
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  resize() {
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.canvas.width = Math.max(1, Math.round(width * ratio));
    this.canvas.height = Math.max(1, Math.round(height * ratio));
    if (this.fitted) this.fit(); else this.draw();
  }

  /** Width and height of what is shown, in pixels of the photograph or of the canvas of the texture. */
  content() {
    const photograph = this.photograph?.size ?? this.redrawn?.size ?? [1, 1];
    const texture = this.texture?.whole ?? photograph;
    if (this.mode === "split") return [0, 1].map(i => Math.max(photograph[i], texture[i]));
    if (this.mode !== "texture") return photograph;
    return this.tiles ? texture.map(side => 3 * side) : texture;
  }

  fit() {
    const [width, height] = this.content();
    // On narrow pages the views stand above the canvas.
    const [above, below] = innerWidth > WIDE ? [ABOVE, 0] : [0, BELOW];
    const room = [this.canvas.clientWidth - 2 * MARGIN, this.canvas.clientHeight - 2 * MARGIN - above - below];
    this.zoom = clamp(Math.min(room[0] / width, room[1] / height, 6), LEAST, MOST);
    this.x = (this.canvas.clientWidth - width * this.zoom) / 2;
    this.y = (this.canvas.clientHeight + above - below - height * this.zoom) / 2;
    this.fitted = true;
    this.moved();
  }

  moved() {
    this.onzoom(this.zoom);
    this.sharper();
    this.draw();
  }

  /** Zooms by a factor; the place at (x, y) of the canvas stays where it is. */
  scale(by, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    const zoom = clamp(this.zoom * by, LEAST, MOST);
    this.x = x - (x - this.x) * zoom / this.zoom;
    this.y = y - (y - this.y) * zoom / this.zoom;
    this.zoom = zoom;
    this.fitted = false;
    this.moved();
  }

  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
    this.draw();
  }

  /** The place in the picture beneath a place of the canvas. */
  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [(event.clientX - box.left - this.x) / this.zoom, (event.clientY - box.top - this.y) / this.zoom];
  }

  draw() {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.paint());
  }

  paint() {
    const { context, canvas } = this;
    const ratio = canvas.width / Math.max(1, canvas.clientWidth);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.setTransform(ratio * this.zoom, 0, 0, ratio * this.zoom, ratio * this.x, ratio * this.y);
    context.imageSmoothingEnabled = this.zoom < 3;
    context.imageSmoothingQuality = "high";
    if (this.mode === "split") this.paintSplit(ratio);
    else if (this.mode === "texture") this.paintTexture();
    else {
      this.paintPicture(this.mode === "redrawn" ? this.redrawn : this.photograph);
      if (this.mode === "elements") {
        this.paintElements();
        this.paintLattice();
      }
    }
    this.paintTool();
    // What lies where, for those who look at the page from outside.
    Object.assign(canvas.dataset, { zoom: this.zoom, left: this.x, top: this.y, elements: this.elements.paths.length });
  }

  paintPicture(picture) {
    if (picture) this.context.drawImage(picture.image, 0, 0, ...picture.size);
  }

  paintTexture() {
    const { texture, context } = this;
    // Until there is a texture, the photograph is what there is to see.
    if (!texture) {
      if (this.mode === "texture") this.paintPicture(this.photograph);
      return;
    }
    const [width, height] = texture.whole;
    const [w, h] = texture.size;
    this.paintGround(width, height);
    if (texture.draft) {
      context.globalAlpha = 0.35;
      if (texture.around) context.drawImage(texture.around, 0, 0, width, height);
      context.globalAlpha = 1;
      context.drawImage(texture.image, (width - w) / 2, (height - h) / 2, w, h);
      return;
    }
    const count = this.tiles && this.mode === "texture" ? 3 : 1;
    for (let row = 0; row < count; row++) {
      for (let column = 0; column < count; column++) {
        context.drawImage(texture.image, column * width, row * height, width, height);
      }
    }
  }

  /** What lies under transparent pictures, and where a texture is still to come. */
  paintGround(width, height) {
    const { context } = this;
    const count = this.tiles && this.mode === "texture" ? 3 : 1;
    context.fillStyle = getComputedStyle(this.canvas).color;
    context.fillRect(0, 0, width * count, height * count);
  }

  paintSplit(ratio) {
    const { context } = this;
    const [width, height] = this.content();
    const at = width * this.split;
    const half = (x, w, paint) => {
      context.save();
      context.beginPath();
      context.rect(x, 0, w, height);
      context.clip();
      paint();
      context.restore();
    };
    half(0, at, () => this.paintPicture(this.photograph ?? this.redrawn));
    half(at, width - at, () => this.paintTexture());
    context.fillStyle = "#fff";
    context.fillRect(at - 1.5 / this.zoom, 0, 3 / this.zoom, height);
    context.fillStyle = "#222";
    context.fillRect(at - 0.5 / this.zoom, 0, 1 / this.zoom, height);
    const middle = (this.canvas.clientHeight / 2 - this.y) / this.zoom;
    context.beginPath();
    context.arc(at, clamp(middle, 0, height), 9 / this.zoom, 0, 7);
    context.fillStyle = "#fff";
    context.fill();
    context.lineWidth = 1.5 / this.zoom;
    context.strokeStyle = "#222";
    context.stroke();
  }

  paintElements() {
    const { context } = this;
    const { paths, categories } = this.elements;
    context.lineJoin = "round";
    context.lineWidth = 3.2 / this.zoom;
    context.strokeStyle = "rgb(0 0 0 / .55)";
    for (const path of paths) context.stroke(path);
    context.lineWidth = 1.7 / this.zoom;
    paths.forEach((path, index) => {
      const category = categories[index];
      const colour = category === undefined || category === null ? "#ffd400" : hue(category);
      if (this.selected.has(index) || this.hovered === index) {
        context.fillStyle = colour;
        context.globalAlpha = this.selected.has(index) ? 0.6 : 0.28;
        context.fill(path, "evenodd");
        context.globalAlpha = 1;
      }
      context.strokeStyle = colour;
      context.stroke(path);
    });
  }

  /** Twice, light in dark, so that it is seen on anything. */
  paintLattice() {
    const { context, lattice } = this;
    if (!lattice) return;
    context.globalAlpha = lattice.followed ? 1 : 0.4;
    context.lineCap = "round";
    for (const [colour, width] of [["#000", 3.4], ["#ff5cf0", 1.7]]) {
      Object.assign(context, { strokeStyle: colour, fillStyle: colour, lineWidth: width / this.zoom });
      context.stroke(lattice.path);
      for (const [from, to] of this.arrows()) {
        context.lineWidth = 2 * width / this.zoom;
        context.beginPath();
        context.moveTo(...from);
        context.lineTo(...to);
        context.stroke();
        context.beginPath();
        context.arc(...to, (4 + width) / this.zoom, 0, 7);
        context.fill();
      }
    }
    context.globalAlpha = 1;
  }

  /** The vectors of the lattice, as arrows from the middle of the photograph. */
  arrows() {
    const [width, height] = this.content();
    const from = [width / 2, height / 2];
    return (this.lattice?.vectors ?? []).map(vector => [from, [0, 1].map(i => from[i] + vector[i])]);
  }

  /** The arrow whose head is at a place; -1 if there is none. */
  arrowAt(place) {
    if (this.mode !== "elements" || this.tool !== "select") return -1;
    return this.arrows().findIndex(([, to]) => Math.hypot(to[0] - place[0], to[1] - place[1]) * this.zoom < 12);
  }

  paintTool() {
    const { context, stroke } = this;
    const tool = this.draws();
    if (!tool) return;
    const brushes = { erase: this.brush, density: this.radius };
    const radius = brushes[tool] ?? 1.2 / this.zoom;
    if (tool === "density" && this.map) {
      // Between strokes, what was made of the map is to be seen.
      context.globalAlpha = stroke.length ? 0.6 : 0.2;
      context.drawImage(this.map, 0, 0, ...this.texture.whole);
      context.globalAlpha = 1;
    }
    if (stroke.length) {
      context.beginPath();
      context.moveTo(...stroke[0]);
      for (const point of stroke) context.lineTo(...point);
      if (tool === "lasso" || tool === "shape") context.setLineDash([5 / this.zoom, 4 / this.zoom]);
      context.lineCap = context.lineJoin = "round";
      context.lineWidth = 2 * radius;
      context.strokeStyle = tool in brushes ? "rgb(230 60 50 / .55)" : "#fff";
      context.stroke();
      context.setLineDash([]);
    }
    if (this.cursor) {
      context.beginPath();
      context.arc(...this.cursor, Math.max(radius, 3 / this.zoom), 0, 7);
      context.lineWidth = 1.5 / this.zoom;
      context.strokeStyle = "#fff";
      context.stroke();
      context.lineWidth = 0.75 / this.zoom;
      context.strokeStyle = "#000";
      context.stroke();
    }
  }

  /** The element at a place of the photograph; -1 if there is none. Elements do not overlap. */
  elementAt([x, y]) {
    const { context } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    return this.elements.paths.findIndex(path => context.isPointInPath(path, x, y, "evenodd"));
  }

  /** The tool or pen that draws in the view; none if dragging moves the picture. */
  draws() {
    if (this.mode === "texture") return this.texture && !this.tiles ? this.pen : null;
    return this.mode === "elements" && this.tool !== "select" ? this.tool : null;
  }

  pointerdown(event) {
    if (this.pipette) { this.takeColour(event); return; }
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.travelled = 0;
    const place = this.place(event);
    const line = this.mode === "split" && Math.abs(place[0] - this.content()[0] * this.split) * this.zoom < 14;
    if (this.pointers.size > 1) this.action = "pinch", this.stroke = [];
    else if (line) this.action = "split";
    else if (this.arrowAt(place) >= 0) this.action = "lattice", this.arrow = this.arrowAt(place);
    else if (event.button === 0 && !event.altKey && this.draws()) this.action = "stroke", this.stroke = [place];
    else this.action = "pan";
    this.draw();
  }

  /** Gives the colour at a place of the canvas to what waits for it; a place without a picture has none. */
  takeColour(event) {
    const { pipette, canvas, context } = this;
    this.pipette = null;
    canvas.style.cursor = "grab";
    const box = canvas.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) * canvas.width / box.width, (event.clientY - box.top) * canvas.height / box.height];
    const [r, g, b, a] = context.getImageData(Math.floor(x), Math.floor(y), 1, 1).data;
    pipette(a === 255 ? `#${[r, g, b].map(value => value.toString(16).padStart(2, "0")).join("")}` : null);
  }

  pointermove(event) {
    const place = this.place(event);
    if (this.pipette) { this.canvas.style.cursor = "crosshair"; return; }
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      this.cursor = place;
      const hovered = this.mode === "elements" && this.tool === "select" ? this.elementAt(place) : -1;
      this.canvas.style.cursor = this.draws() ? "crosshair" : this.arrowAt(place) >= 0 ? "move" : hovered >= 0 ? "pointer" : "grab";
      if (hovered !== this.hovered || this.draws()) { this.hovered = hovered; this.draw(); }
      return;
    }
    const now = [event.clientX, event.clientY];
    this.travelled += Math.hypot(now[0] - before[0], now[1] - before[1]);
    if (this.action === "pinch" && this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
      const length = at => Math.hypot(at[0] - other[0], at[1] - other[1]);
      const box = this.canvas.getBoundingClientRect();
      this.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
      this.scale(length(now) / Math.max(1, length(before)), (now[0] + other[0]) / 2 - box.left, (now[1] + other[1]) / 2 - box.top);
    } else if (this.action === "split") {
      this.onsplit(clamp(place[0] / this.content()[0], 0, 1));
    } else if (this.action === "lattice") {
      const from = this.arrows()[this.arrow]?.[0];
      if (from) this.lattice.vectors[this.arrow] = [0, 1].map(i => Math.round(10 * (place[i] - from[i])) / 10);
      this.draw();
    } else if (this.action === "stroke") {
      this.stroke.push(place);
      this.cursor = place;
      this.draw();
    } else if (this.action === "pan" && this.travelled > REACH) {
      this.canvas.style.cursor = "grabbing";
      this.pan(now[0] - before[0], now[1] - before[1]);
    }
    this.pointers.set(event.pointerId, now);
  }

  pointerup(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.action === "stroke") this.finish();
    else if (this.action === "lattice") {
      if (this.travelled > REACH && this.lattice) this.onlattice(this.lattice.vectors);
    }
    else if (this.action === "pan" && this.travelled <= REACH && this.mode === "elements" && event.button === 0) {
      // Fingers have no keys: each tap selects one more, or one less.
      this.onpick(this.elementAt(this.place(event)), event.shiftKey || event.ctrlKey || event.metaKey || event.pointerType === "touch");
    }
    if (!this.pointers.size) this.action = null;
    this.canvas.style.cursor = "";
  }

  pointercancel(event) {
    this.pointers.delete(event.pointerId);
    this.stroke = [];
    this.action = null;
    this.draw();
  }

  pointerleave() {
    if (this.pointers.size) return;
    this.cursor = null;
    this.hovered = -1;
    this.draw();
  }

  wheel(event) {
    event.preventDefault();
    const box = this.canvas.getBoundingClientRect();
    const lines = event.deltaMode === 1 ? 16 : 1;
    const by = Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0018));
    this.scale(by, event.clientX - box.left, event.clientY - box.top);
  }

  /** Hands on what was drawn. */
  finish() {
    const stroke = this.stroke;
    this.stroke = [];
    this.draw();
    if (stroke.length && this.draws()) this.onstroke(this.draws(), stroke);
  }

  keydown(event) {
    if (event.ctrlKey || event.metaKey) return;
    const step = event.shiftKey ? 120 : 40;
    const ways = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const way = ways[event.key];
    if (this.draws() && way) {
      // With a tool, the arrows move its place.
      const by = (event.shiftKey ? 24 : 4) / this.zoom;
      const [width, height] = this.content();
      const [x, y] = this.cursor ?? [width / 2, height / 2];
      this.cursor = [clamp(x - way[0] * by, 0, width), clamp(y - way[1] * by, 0, height)];
      if (this.stroke.length) this.stroke.push(this.cursor);
      this.draw();
    } else if (this.draws() && event.key === " ") {
      if (this.stroke.length) this.finish();
      else this.stroke = [this.cursor ?? this.content().map(side => side / 2)];
      this.draw();
    } else if (way) this.pan(way[0] * step, way[1] * step);
    else if (event.key === "+" || event.key === "=") this.scale(1.25);
    else if (event.key === "-") this.scale(0.8);
    else if (event.key === "0") this.fit();
    else if (event.key === "1") this.scale(1 / this.zoom);
    else if (this.mode === "elements" && this.tool === "select" && ["n", "p", "Enter"].includes(event.key)) {
      this.step(event);
    } else return;
    event.preventDefault();
  }

  /** Goes to the next or the previous element, or selects the one gone to. */
  step(event) {
    const count = this.elements.paths.length;
    if (!count) return;
    if (event.key === "Enter") {
      if (this.hovered >= 0) this.onpick(this.hovered, true);
      return;
    }
    const next = event.key === "n" ? this.hovered + 1 : this.hovered - 1;
    this.hovered = (next + count) % count;
    // It is brought into sight.
    const [x, y] = this.elements.places[this.hovered].map((v, i) => v * this.zoom + [this.x, this.y][i]);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (x < 0 || y < 0 || x > width || y > height) this.pan(width / 2 - x, height / 2 - y);
    this.draw();
  }
}
