"use strict";
// What all parts of the script use: data, elements, numbers, files, colours.

const data = JSON.parse(document.getElementById("data").textContent);
const scene = data.scene;
const state = { group: 0, texton: null };

const byId = (id) => document.getElementById(id);
const group = () => data.groups[state.group];

// An element with attributes and children; names that begin with "on" are listeners.
function make(space, name, attributes, children) {
  const element = space ? document.createElementNS(space, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key === "style") Object.entries(value).forEach(([k, v]) => element.style.setProperty(k, v));
    else element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}
const el = (name, attributes, ...children) => make(null, name, attributes, children);
const vector = (name, attributes, ...children) =>
  make("http://www.w3.org/2000/svg", name, attributes, children);

// Thousands are set apart by narrow spaces at which no line breaks.
const integer = (v) => Math.round(v).toLocaleString("en").replaceAll(",", "\u202f");
const area = (v) => `${integer(v)}\u202fpx²`;
const percent = (v, digits = 1) => `${(100 * v).toFixed(digits)}\u202f%`;
const short = (v) => String(Number(v.toPrecision(4)));
const plural = (n, one, many) => `${integer(n)} ${n === 1 ? one : many}`;

// The bytes of a file of the page, and its text, unpacked once.
const unpacked = new Map();
function bytesOf(id) {
  const text = atob(byId(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}
function textOf(id) {
  if (!unpacked.has(id)) {
    const stream = new Blob([bytesOf(id)]).stream().pipeThrough(new DecompressionStream("gzip"));
    unpacked.set(id, new Response(stream).text());
  }
  return unpacked.get(id);
}
const photoAddress = (id) => `data:${byId(id).dataset.type};base64,${byId(id).textContent}`;

// An image that is ready to be drawn.
function loaded(address) {
  return new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = () => resolve(image);
    image.onerror = () => reject(new Error("a picture cannot be drawn"));
    image.src = address;
  });
}

// A colour for each category that is told apart from its neighbours, on light and on dark.
const categoryColour = (id) => {
  const lightness = [0.7, 0.58, 0.78][id % 3];
  return `oklch(${lightness} 0.14 ${((id * 137.508 + 25) % 360).toFixed(1)})`;
};

// Number and name of a category.
const categoryName = (id) => `${id} ${group().categories.find((c) => c.id === id)?.name ?? ""}`;

// What goes wrong is said on the page, not only to the console.
function fail(error) {
  const box = byId("failure");
  box.hidden = false;
  box.textContent = `This page could not be shown in full: ${error?.message ?? error}. `
    + "It needs a browser of 2023 or later.";
  console.error(error);
}
