// Distributions, exemplar against result, as drawings with axes.

const PLOT = { width: 340, height: 190, left: 42, right: 16, top: 8, bottom: 36 };

// Round values that divide a range into about so many parts.
function ticksOf(from, to, count) {
  const least = (to - from) / count;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= least * 0.999);
  const ticks = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to * (1 + 1e-9); k++) ticks.push(k * step);
  return ticks;
}

// Powers of ten, or of two where there would be less than two of ten.
function powersOf(from, to) {
  for (const base of [10, 4, 2]) {
    const ticks = [];
    for (let k = Math.ceil(Math.log(from) / Math.log(base) - 1e-9); base ** k <= to * (1 + 1e-9); k++) {
      ticks.push(base ** k);
    }
    if (ticks.length >= 3) return ticks;
  }
  return [from, to];
}

// A line in steps along bins, broken where a value is not known.
function stepped(values, edges, x, y) {
  let path = "";
  let open = false;
  values.forEach((value, i) => {
    if (value === null) {
      open = false;
      return;
    }
    path += `${open ? "L" : "M"}${x(edges[i])} ${y(value)}H${x(edges[i + 1])}`;
    open = true;
  });
  return path;
}

// The same, down to zero.
function filled(values, edges, x, y) {
  let path = "";
  values.forEach((value, i) => {
    if (value) path += `M${x(edges[i])} ${y(0)}V${y(value)}H${x(edges[i + 1])}V${y(0)}z`;
  });
  return path;
}

function drawPlot(plot) {
  const { width, height, left, right, top, bottom } = PLOT;
  const edges = plot.edges;
  const [from, to] = [edges[0], edges[edges.length - 1]];
  const scale = plot.logarithmic ? Math.log : (v) => v;
  const round = (v) => Math.round(v * 100) / 100;
  const x = (v) => round(left + ((width - left - right) * (scale(v) - scale(from))) / (scale(to) - scale(from)));
  const values = [...(plot.exemplar ?? []), ...(plot.result ?? [])].filter((v) => v !== null);
  const most = Math.max(plot.neutral ? 1.6 * plot.neutral : 1e-6, ...values) * 1.05;
  const y = (v) => round(top + (height - top - bottom) * (1 - v / most));
  const base = height - bottom;
  const drawing = [];
  for (const tick of ticksOf(0, most, 4)) {
    drawing.push(vector("line", { class: "grid", x1: left, x2: width - right, y1: y(tick), y2: y(tick) }));
    drawing.push(vector("text", { class: "tick", x: left - 6, y: y(tick) + 3.5, "text-anchor": "end" }, short(tick)));
  }
  for (const tick of plot.logarithmic ? powersOf(from, to) : ticksOf(from, to, 6)) {
    drawing.push(vector("line", { class: "axis", x1: x(tick), x2: x(tick), y1: base, y2: base + 4 }));
    drawing.push(vector("text", { class: "tick", x: x(tick), y: base + 15, "text-anchor": "middle" }, short(tick)));
  }
  if (plot.neutral) {
    const at = y(plot.neutral);
    drawing.push(vector("line", { class: "neutral", x1: left, x2: width - right, y1: at, y2: at }));
  }
  if (plot.exemplar) {
    drawing.push(vector("path", { class: "area exemplar", d: filled(plot.exemplar, edges, x, y) }));
    drawing.push(vector("path", { class: "line exemplar", d: stepped(plot.exemplar, edges, x, y) }));
  }
  if (plot.result) drawing.push(vector("path", { class: "line result", d: stepped(plot.result, edges, x, y) }));
  drawing.push(vector("line", { class: "axis", x1: left, x2: width - right, y1: base, y2: base }));
  drawing.push(vector("text", { class: "label", x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle" }, plot.x));
  const middle = (top + base) / 2;
  drawing.push(vector("text", { class: "label", x: 11, y: middle, "text-anchor": "middle", transform: `rotate(-90 11 ${middle})` }, plot.y));
  const readout = el("output", { class: "readout" });
  const cursor = vector("rect", { class: "cursor", x: 0, y: top, width: 0, height: base - top });
  const svg = vector("svg", {
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": `${plot.title}: ${plot.y} over ${plot.x}`,
    onpointermove: (event) => {
      const box = svg.getBoundingClientRect();
      const px = ((event.clientX - box.left) * width) / box.width;
      const bin = edges.findIndex((edge, i) => i + 1 < edges.length && px >= x(edge) && px < x(edges[i + 1]));
      cursor.setAttribute("width", bin < 0 ? 0 : x(edges[bin + 1]) - x(edges[bin]));
      if (bin >= 0) cursor.setAttribute("x", x(edges[bin]));
      const value = (name, list) => (list && list[bin] !== null ? ` · ${name} ${short(list[bin])}` : "");
      readout.value = bin < 0 ? "" : `${short(edges[bin])} – ${short(edges[bin + 1])}`
        + value("exemplar", plot.exemplar) + value("result", plot.result);
    },
    onpointerleave: () => {
      readout.value = "";
      cursor.setAttribute("width", 0);
    },
  }, cursor, ...drawing);
  const dots = (plot.categories ?? []).map((id) => el("i", { class: "dot", style: { background: categoryColour(id) } }));
  return el("figure", { class: "plot" }, el("figcaption", null, ...dots, plot.title), svg, readout);
}

function makePlots() {
  const plots = group()?.distributions ?? [];
  const box = byId("plots");
  box.replaceChildren(...plots.filter((plot) => !plot.categories).map(drawPlot));
  const pairs = plots.filter((plot) => plot.categories);
  if (pairs.length > 0) {
    box.append(
      el("h3", null, "Pair correlation by category"),
      el("p", { class: "lead" }, "How many more pairs of primaries stand at a distance than if all were scattered at random, "
        + "within and between the categories that cover most: below 1 they keep apart, above 1 they seek each other."),
      ...pairs.map(drawPlot));
  }
  const lead = byId("distributions-lead");
  const legend = [];
  if (plots.some((plot) => plot.exemplar)) legend.push(el("span", { class: "key exemplar" }, "exemplar"));
  if (plots.some((plot) => plot.result)) legend.push(el("span", { class: "key result" }, "result"));
  const doubt = scene && (scene.domain || data.groups.length > 1)
    ? " The result does not fill its canvas evenly, so its pair correlation says little." : "";
  lead.replaceChildren(...(plots.length === 0 ? ["There is nothing to count."] : legend), doubt);
}
