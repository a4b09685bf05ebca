// Categories as a contact sheet: their textons, how many, and how much they cover.

const FIRST = 15;
const THUMB = 44;
let thumbs = { pictures: new Map(), addresses: [] };

// The groups of a picture that hold one primary each, by id, with the brushes of their soft ellipses. These are
// in a group of their own.
async function cutOut(picture) {
  const text = await textOf(picture);
  const brushes = new Map([...text.matchAll(/^<radialGradient id="(u\d+)g".*$/gm)].map((found) => [found[1], found[0]]));
  const pieces = new Map();
  const groups = /<g id="p(\d+)" class="category-[\d-]+"[^>]*>((?:<g [^>]*>[^]*?<\/g>|[^])*?)<\/g>/g;
  for (const [, id, inside] of text.matchAll(groups)) {
    const used = new Set([...inside.matchAll(/"#(u\d+)"/g)].map((found) => brushes.get(found[1])));
    pieces.set(Number(id), `<defs>${[...used].join("")}</defs>${inside}`);
  }
  return pieces;
}

// A texton alone, as the address of an image.
function thumbAddress(texton) {
  const [x, y, w, h] = texton.bounds;
  const svg = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    + `width="${w + 2}" height="${h + 2}" viewBox="${x - 1} ${y - 1} ${w + 2} ${h + 2}">`
    + `${thumbs.pictures.get(texton.id) ?? ""}</svg>`;
  const address = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  thumbs.addresses.push(address);
  return address;
}

function makeThumb(texton, usual) {
  const size = Math.max(texton.bounds[2], texton.bounds[3]) + 2;
  const shown = Math.min(THUMB, Math.max(6, (THUMB * 0.62 * size) / usual));
  const scale = shown / size;
  const times = scene && group().in_scene ? `, placed ${texton.placed}×` : "";
  const cut = texton.clipped ? ", cut by the border" : "";
  const about = `Primary ${texton.source}, ${area(texton.area)}${times}${cut}`;
  const image = el("img", {
    alt: "",
    loading: "lazy",
    src: thumbAddress(texton),
    width: Math.max(1, Math.round((texton.bounds[2] + 2) * scale)),
    height: Math.max(1, Math.round((texton.bounds[3] + 2) * scale)),
  });
  return el("button", {
    type: "button",
    class: `thumb${texton.clipped ? " clipped" : ""}`,
    title: about,
    "aria-label": about,
    "aria-pressed": "false",
    "data-texton": texton.source,
    onclick: (event) => choose(texton, event.currentTarget),
  }, image);
}

// What the two shares are called. Of several exemplars each covers a part of the result, so less of
// each is wanted than it has.
function shareNames() {
  if (!group().library || !group().in_scene) return ["covers", "covers"];
  return data.groups.length > 1 ? ["exemplar", "result"] : ["wanted", "got"];
}

function makeBars(category, most) {
  const bar = (name, value, kind) =>
    value === null || value === undefined ? null : el("div", { class: "share" },
      el("span", null, name),
      el("div", { class: "track" },
        el("div", { class: `fill ${kind}`, style: { width: `${(100 * value) / most}%` } })),
      el("span", { class: "number" }, percent(value, 2)));
  const [wanted, got] = shareNames();
  return [bar(wanted, category.wanted, "exemplar"), bar(got, category.got, "result")];
}

function makeCard(category, usual, most) {
  const order = (a, b) => a.clipped - b.clipped || b.placed - a.placed || b.area - a.area || a.source - b.source;
  const members = group().textons.filter((texton) => texton.category === category.id).sort(order);
  const known = category.members === null
    ? null
    : `${plural(category.members, "primary", "primaries")}, ${integer(category.whole)} whole`;
  const placed = category.placed === null ? null : `${integer(category.placed)} placed`;
  const list = el("div", { class: "thumbs" }, members.slice(0, FIRST).map((t) => makeThumb(t, usual)));
  const more = members.length <= FIRST ? null : el("button", {
    type: "button",
    class: "quiet",
    onclick: (event) => {
      event.currentTarget.remove();
      list.append(...members.slice(FIRST).map((t) => makeThumb(t, usual)));
    },
  }, `All ${integer(members.length)}`);
  return el("article", { class: "card", "data-category": category.id },
    el("h3", null,
      el("i", { class: "dot large", style: { background: category.colour }, title: category.colour }),
      `${category.id} ${category.name}`,
      el("i", {
        class: "dot",
        style: { background: categoryColour(category.id) },
        title: "Its colour in maps",
      })),
    el("p", { class: "faint" },
      [known, placed, `${area(category.area)} on average`].filter(Boolean).join(" · ")),
    ...makeBars(category, most),
    list, more);
}

async function makeCategories() {
  thumbs.addresses.forEach((address) => URL.revokeObjectURL(address));
  thumbs = { pictures: new Map(), addresses: [] };
  const about = group();
  const cards = byId("cards");
  makeSurroundings();
  cards.replaceChildren();
  const categories = about?.categories ?? [];
  byId("categories-legend").hidden = categories.length === 0;
  if (categories.length === 0) {
    byId("categories-lead").textContent = "There are no primaries, so there are no categories.";
    return;
  }
  const shares = !about.in_scene || !about.library ? "" : data.groups.length > 1
    ? `In the exemplar they cover ${percent(about.library.coverage)}; in the result, which is made from several, `
      + `primaries cover ${percent(scene.coverage)}.`
    : `Coverage is wanted as in the exemplar: ${percent(about.library.coverage)} in all; `
      + `the result has ${percent(scene.coverage)}.`;
  byId("categories-lead").textContent = shares
    ? `Primaries that look alike. ${shares} Choose a primary to see what stands around it.`
    : "Primaries that look alike, with the share of the picture that they cover."
      + (about.library ? " Choose a primary to see what stands around it." : "");
  const sizes = about.textons.map((t) => Math.max(t.bounds[2], t.bounds[3]) + 2).sort((a, b) => a - b);
  const usual = sizes[Math.floor(sizes.length / 2)] ?? 1;
  const most = Math.max(1e-9, ...categories.flatMap((c) => [c.wanted ?? 0, c.got ?? 0]));
  const turn = state.group;
  const pictures = await cutOut(about.picture);
  if (turn !== state.group) return;
  thumbs.pictures = pictures;
  cards.append(...categories.map((category) => makeCard(category, usual, most)));
}
