// What is drawn on the canvas of the texture: how dense elements stand, and the shape that they fill.

import { ask, tell } from "./server.js";
import { explanation, make } from "./dom.js";

/** Longest side of the map of densities, in its pixels. */
const LONGEST = 512;

const grey = density => { const level = Math.round(density * 127.5); return `rgb(${level} ${level} ${level})`; };

export class Paint {
  constructor(view, { onview }) {
    Object.assign(this, { view, onview, density: 0, sum: null });
  }

  /** Takes a pen up, or puts it down. */
  take(pen) {
    this.view.pen = this.view.pen === pen ? null : pen;
    this.view.stroke = [];
    if (this.view.pen) {
      this.view.tiles = document.getElementById("tiles").checked = false;
      this.onview("texture");
    }
    this.follow(this.work);
    this.onchange();
    this.view.draw();
  }

  /** Brings the map up to date with what is set. */
  follow(work) {
    this.work = work;
    const { whole } = work.texture ?? {};
    if (this.view.pen !== "density" || !whole) return;
    const by = Math.min(1, LONGEST / Math.max(...whole));
    const size = whole.map(side => Math.max(1, Math.round(side * by)));
    const sum = `${work.id} ${work.files.density?.sum ?? ""} ${size}`;
    if (this.sum === sum) return;
    this.sum = sum;
    const map = make("canvas", { width: size[0], height: size[1] });
    const shown = () => { if (this.sum === sum) { this.view.map = map; this.view.draw(); } };
    if (!work.files.density) shown();
    else ask("picture", { of: "density", sum: work.files.density.sum }).then(answer => answer.blob()).then(createImageBitmap).then(image => {
      map.getContext("2d").drawImage(image, 0, 0, ...size);
      shown();
    }, () => { this.sum = null; });
  }

  /** What was drawn with a pen. */
  stroke(pen, path) {
    const { whole } = this.work.texture;
    if (pen === "shape") {
      // The shape is done; dragging moves the picture again.
      this.take(pen);
      return tell("draw", { size: whole, path });
    }
    const { map } = this.view;
    if (!map) return undefined;
    const by = map.width / whole[0], context = map.getContext("2d");
    const width = 2 * this.view.radius * by;
    // As in the photograph is what was not painted on.
    context.globalCompositeOperation = this.density === 1 ? "destination-out" : "source-over";
    context.filter = `blur(${(width / 8).toFixed(2)}px)`;
    context.lineCap = context.lineJoin = "round";
    context.lineWidth = width;
    context.strokeStyle = grey(this.density);
    context.beginPath();
    context.moveTo(path[0][0] * by, path[0][1] * by);
    for (const [x, y] of path) context.lineTo(x * by, y * by);
    context.stroke();
    this.view.draw();
    return new Promise(done => map.toBlob(blob => done(tell("paint", blob)), "image/png"));
  }

  /** The controls of a pen, while it is in use. */
  controls(pen) {
    if (this.view.pen !== pen) return null;
    if (pen === "shape") return explanation("pen-words", "Draw the outline of the shape. Keys: arrows move the pen, the space bar begins and ends.");
    const slider = (id, label, least, most, step, value, onset) => {
      const input = make("input", { type: "range", id, min: least, max: most, step, value, "data-key": id });
      input.addEventListener("input", () => { onset(Number(input.value)); this.view.draw(); });
      return make("div", {}, make("label", { for: id, textContent: label }), input);
    };
    const names = [[0, "None"], [0.5, "Half"], [1, "As before"], [2, "Twice"]];
    const buttons = names.map(([density, name]) => make("button", {
      type: "button", textContent: name, "aria-pressed": String(this.density === density), "data-key": `density-${density}`,
      onclick: () => { this.density = density; this.onchange(); },
    }));
    return make("div", {}, make("div", { className: "row even", role: "group", "aria-label": "Density that the brush paints" }, ...buttons),
      slider("pen-radius", "Radius of the brush", 4, 200, 1, this.view.radius, radius => { this.view.radius = radius; }),
      explanation("pen-words", "Paint on the texture. Keys: arrows move the brush, the space bar begins and ends."));
  }
}
