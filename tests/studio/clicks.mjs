// What a user does in the studio, by clicking; what is saved is what the copied command makes.

import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import assert from "node:assert/strict";
import { chromium } from "playwright-core";
import { LONG, Studio } from "./driver.mjs";

const { BROWSER, EXEMPLARS } = process.env;
const folders = [];

function folder(...exemplars) {
  const made = mkdtempSync(join(tmpdir(), "vtex-studio-"));
  folders.push(made);
  for (const name of exemplars) copyFileSync(join(EXEMPLARS, name), join(made, name));
  return made;
}

/** A folder with a corner of an exemplar, which is soon analysed. */
async function corner(name, side) {
  const made = folder();
  const browser = await chromium.launch({ executablePath: BROWSER, args: ["--no-sandbox"] });
  const page = await browser.newPage();
  const picture = readFileSync(join(EXEMPLARS, name)).toString("base64");
  await page.setContent(`<body style="margin: 0"><img src="data:image/png;base64,${picture}">`);
  await page.screenshot({ path: join(made, name), clip: { x: 0, y: 0, width: side, height: side } });
  await browser.close();
  return made;
}

const told = (text, ...seconds) => console.log(`  ${text}: ${seconds.map(one => `${one.toFixed(2)} s`).join(", ")}`);

async function photograph() {
  const studio = await Studio.start(folder(), []);
  const { page } = studio;
  await studio.picture("welcome");
  await studio.accessible("welcome");

  // Open: the page sends the file, and it is put into the folder.
  told("photograph to first texture", await studio.made(() => page.setInputFiles("#file", join(EXEMPLARS, "terrazzo.png"))));
  assert.ok(existsSync(join(studio.folder, "terrazzo.png")));
  await studio.same("svg");

  // Steer.
  await studio.tab("steer");
  await page.fill("#knob-size", "600");
  await studio.made(async () => { await page.fill("[aria-label='Height of the canvas']", "600"); await page.keyboard.press("Tab"); });
  told("a knob turned to a draft at 600 x 600, and to the whole", ...await studio.drafted(() => page.click("text=New seed")));
  await studio.made(() => page.selectOption("#knob-tile", "both"));
  await studio.made(async () => { await page.fill("#knob-rotate", "25"); await page.keyboard.press("Tab"); });
  await studio.made(() => page.check("#knob-mirror"));
  const options = { size: "600x600", tile: "both", rotate: "25", mirror: "true" };
  assert.deepEqual((await studio.state()).work.options, options);
  await page.check("#tiles");
  await studio.picture("tiles");
  await page.uncheck("#tiles");
  await studio.same("svg");
  await studio.tab("steer");
  await page.click("text=Variants");
  await page.waitForFunction(() => document.querySelectorAll(".variants img").length === 6, null, { timeout: LONG });
  await page.waitForFunction(() => [...document.querySelectorAll(".variants img")].every(image => image.naturalWidth > 0));
  const seed = await page.getAttribute(".variants button >> nth=3", "title");
  await studio.made(() => page.click(".variants button >> nth=3"));
  assert.equal(`Seed ${(await studio.state()).work.seed}`, seed);
  await studio.picture("steer");
  await studio.accessible("steer");
  // What is out of range is refused, and nothing changes.
  await page.fill("#knob-rotate", "500");
  await page.keyboard.press("Tab");
  await page.waitForSelector(".notice.fault");
  assert.match(await page.textContent(".notice.fault"), /0 to 180 degrees/);
  assert.equal((await studio.state()).work.options.rotate, "25");
  await page.click(".notice.fault button");

  // Mend.
  await studio.tab("mend");
  const places = await studio.elements();
  const found = places.length;
  await studio.picture("mend");
  await studio.accessible("mend");
  await page.mouse.click(...await studio.at(...places[0]));
  told("an element deleted to a draft of the new texture, and to the whole", ...await studio.drafted(() => page.keyboard.press("Delete")));
  assert.equal((await studio.state()).work.elements.count, found - 1);
  assert.ok(existsSync(join(studio.folder, "terrazzo.masks.json")));
  const [a, b] = await studio.elements();
  await page.mouse.click(...await studio.at(...a));
  await page.keyboard.down("Shift");
  await page.mouse.click(...await studio.at(...b));
  await page.keyboard.up("Shift");
  assert.match(await page.textContent("#mend h2 >> nth=1"), /2 elements/);
  await studio.made(() => page.click("#mend >> text=Merge"));
  assert.equal((await studio.state()).work.elements.count, found - 2);
  const drag = async (...places) => {
    const [first, ...others] = await Promise.all(places.map(place => studio.at(...place)));
    await page.mouse.move(...first);
    await page.mouse.down();
    for (const place of others) await page.mouse.move(...place, { steps: 4 });
    await page.mouse.up();
  };
  await page.click("#mend >> text=Erase");
  await studio.made(() => drag([14, 14], [66, 14], [66, 24], [14, 24], [14, 34], [66, 34], [66, 44], [14, 44], [14, 54], [66, 54]));
  const erased = (await studio.state()).work.elements.count;
  await page.click("#mend >> text=Draw element");
  await studio.made(() => drag([20, 20], [60, 20], [60, 50], [20, 50], [20, 20]));
  assert.equal((await studio.state()).work.elements.count, erased + 1);
  await page.click("#mend >> text=Cut");
  await studio.made(() => drag([40, 10], [40, 60]));
  assert.equal((await studio.state()).work.elements.count, erased + 2);
  // Undo, redo, by keys.
  await page.focus("#canvas");
  await page.keyboard.press("Control+z");
  await studio.until(({ work }) => work.elements?.count === erased + 1);
  await studio.made(() => page.keyboard.press("Control+Shift+z"));
  assert.equal((await studio.state()).work.elements.count, erased + 2);
  const mended = await studio.same("svg");
  assert.match(mended.command, /--masks terrazzo\.masks\.json/);
  await studio.same("library");

  // Change.
  await studio.tab("change");
  const recolour = colour => page.$eval("[data-key=colour-1]", (input, colour) => {
    input.value = colour;
    input.dispatchEvent(new Event("change"));
  }, colour);
  told("a category recoloured", await studio.made(() => recolour("#d03020")));
  await studio.made(() => recolour("#2040c0"));
  assert.equal((await studio.state()).work.operations.length, 1);
  await page.selectOption("#operation", "shadow");
  await page.fill("#word-length", "7");
  await page.press("#word-length", "Tab");
  await studio.made(() => page.click("#change >> text=Add >> nth=-1"));
  await page.selectOption("#operation", "thin");
  await page.fill("#word-keep", "0.9");
  await page.press("#word-keep", "Tab");
  await page.selectOption("#which", "layer:secondary");
  await studio.made(() => page.click("#change >> text=Add >> nth=-1"));
  const operations = (await studio.state()).work.operations;
  assert.deepEqual(operations.slice(1), ["shadow --length 7", "thin 0.9 --layer secondary"]);
  await studio.made(() => page.click("[data-key=up-2]"));
  await studio.picture("change");
  await studio.accessible("change");
  for (const format of ["svg", "pdf", "scene"]) await studio.same(format);
  const scaled = await studio.same("png", { scale: 1.5 });
  assert.match(scaled.command, /--scale 1\.5/);
  await studio.picture("save");
  await studio.accessible("save");

  // Looks.
  await studio.view("split");
  await studio.picture("split");
  await page.emulateMedia({ colorScheme: "dark" });
  await studio.tab("steer");
  await studio.picture("dark");
  await studio.accessible("dark");
  await page.setViewportSize({ width: 820, height: 1180 });
  await studio.picture("tablet");
  await studio.accessible("tablet");
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.equal(wide, 0, "nothing sticks out to the right");
  await page.setViewportSize({ width: 1280, height: 720 });

  // Killed and started again, it goes on.
  await studio.tab("save");
  await page.check("[name=format][value=svg]");
  await page.waitForFunction(() => document.querySelector("#lines").textContent.includes("edited.svg"));
  const before = await page.textContent("#lines");
  const work = (await studio.state()).work;
  await studio.kill();
  studio.faults = studio.faults.filter(fault => !/ERR_|Failed to load/.test(fault));
  await studio.run(["terrazzo.png"]);
  await studio.until(({ work, busy }) => !busy && work?.texture && !work.texture.draft);
  await page.waitForFunction(before => document.querySelector("#lines").textContent === before, before);
  const after = (await studio.state()).work;
  assert.deepEqual([after.options, after.operations, after.seed, after.mended], [work.options, work.operations, work.seed, work.mended]);
  assert.ok(after.restored);
  studio.faults = studio.faults.filter(fault => !/ERR_|Failed to load|status of 422/.test(fault));
  await studio.stop();
}

/** A shape and a map that steer; a library, a scene and a drawing. */
async function others() {
  const studio = await Studio.start(folder("leaves.png"), ["leaves.png"]);
  const { page } = studio;
  await studio.made(async () => {});
  await page.fill("#knob-size", "300");
  await studio.made(async () => { await page.fill("[aria-label='Height of the canvas']", "240"); await page.keyboard.press("Tab"); });
  const shape = join(folder(), "disc.svg");
  writeFileSync(shape, "<svg xmlns='http://www.w3.org/2000/svg' width='90' height='90'><circle cx='45' cy='45' r='40'/></svg>");
  await studio.made(() => page.setInputFiles("[type=file][aria-label='Shape to fill']", shape));
  const shaped = await studio.same("svg");
  assert.match(shaped.command, /--domain disc\.svg/);
  assert.ok(existsSync(join(studio.folder, "disc.svg")));
  const library = await studio.same("library"), scene = await studio.same("scene");
  const open = (name, buffer) => page.setInputFiles("#file", { name, mimeType: "application/json", buffer });
  await studio.made(() => open("other.lib.json", library.saved));
  await studio.same("svg");
  await page.waitForTimeout(200);
  assert.ok(await page.isDisabled("[name=view][value=elements]"));
  await studio.made(() => open("other.scene.json", scene.saved));
  const rendered = await studio.same("svg");
  assert.match(rendered.command, /^vtex render other\.scene\.json/);
  await studio.tab("change");
  await page.selectOption("#operation", "flatten");
  await studio.made(() => page.click("#change >> text=Add >> nth=-1"));
  await studio.same("png", { scale: 0.5 });
  // What cannot be opened is told.
  await open("notes.json", Buffer.from("{}"));
  await page.waitForSelector(".notice.fault");
  assert.ok(!existsSync(join(studio.folder, "notes.json")));
  studio.faults = studio.faults.filter(fault => !/status of 422/.test(fault));
  await page.selectOption("#open-files", { label: "leaves.png" });
  await page.waitForFunction(() => document.title.startsWith("leaves.png"));
  await studio.stop();
}

/** A studio with a corner of the leaves and a texture of 360 × 300 px, once it is made. */
async function smallLeaves() {
  const studio = await Studio.start(await corner("leaves.png", 300), ["leaves.png"]);
  const { page } = studio;
  await studio.finished();
  await page.fill("#knob-size", "360");
  await studio.made(async () => { await page.fill("[aria-label='Height of the canvas']", "300"); await page.keyboard.press("Tab"); });
  return studio;
}

/** What is painted on the texture, categories left out, a palette from a picture; two files of one name. */
async function painted() {
  const studio = await smallLeaves();
  const { page } = studio;
  const whole = (await studio.state()).work.texture.elements;
  const stroke = async (...places) => {
    const [first, ...others] = await Promise.all(places.map(place => studio.at(...place)));
    await page.mouse.move(...first);
    await page.mouse.down();
    for (const place of others) await page.mouse.move(...place, { steps: 4 });
    await page.mouse.up();
  };
  // Density: nothing in a band across the middle.
  await page.click("[data-key=pen-density]");
  await page.click("[data-key=density-0]");
  await studio.made(() => stroke([10, 150], [350, 150]));
  const thinner = (await studio.state()).work.texture.elements;
  assert.ok(thinner < 0.9 * whole, `${thinner} of ${whole}`);
  assert.ok(existsSync(join(studio.folder, "leaves.density.png")));
  await studio.picture("density");
  await studio.accessible("density");
  const first = readFileSync(join(studio.folder, "leaves.density.png"));
  await page.click("[data-key=density-2]");
  await studio.made(() => stroke([30, 40], [330, 40]));
  assert.ok(!readFileSync(join(studio.folder, "leaves.density.png")).equals(first), "the map is painted further, in its file");
  // Undo brings the file back, byte by byte.
  await studio.made(() => page.click("#undo"));
  assert.ok(readFileSync(join(studio.folder, "leaves.density.png")).equals(first));
  await studio.made(() => page.click("#redo"));
  const dense = await studio.same("svg");
  assert.match(dense.command, /--density leaves\.density\.png/);
  await studio.tab("steer");
  await studio.made(() => page.click("[data-key=reset-density]"));
  // A shape, drawn.
  await page.click("[data-key=pen-shape]");
  await studio.made(() => stroke([40, 40], [320, 60], [300, 260], [150, 280], [40, 200], [40, 40]));
  await studio.picture("shape");
  await studio.accessible("shape");
  assert.equal(await page.getAttribute("[data-key=pen-shape]", "aria-pressed"), "false");
  const shaped = await studio.same("svg");
  assert.match(shaped.command, /--domain leaves\.domain\.svg/);
  // Colours of a picture.
  await studio.tab("change");
  await studio.made(() => page.click("#change >> text=Add >> nth=-1"));
  await studio.made(() => page.setInputFiles("[aria-label='Palette from a picture']", join(EXEMPLARS, "flowers.png")));
  const recoloured = await studio.same("svg");
  assert.match(recoloured.command, /--op 'palette flowers\.colours\.txt' --op shadow/);
  await studio.tab("change");
  await studio.picture("palette");
  await studio.accessible("palette");
  await studio.made(() => page.click("[data-key=palette-reset]"));
  assert.deepEqual((await studio.state()).work.operations, ["shadow"]);
  // It goes on after a restart with what was drawn.
  await studio.kill();
  studio.faults = studio.faults.filter(fault => !/ERR_|Failed to load/.test(fault));
  // Another file of the same name is another.
  mkdirSync(join(studio.folder, "other"));
  copyFileSync(join(await corner("terrazzo.png", 200), "terrazzo.png"), join(studio.folder, "other", "leaves.png"));
  await studio.run(["leaves.png", "other/leaves.png"]);
  await studio.until(({ work, busy }) => !busy && work?.texture && !work.texture.draft);
  assert.ok((await studio.state()).work.files.domain.drawn);
  await studio.same("svg");
  const own = (await studio.state()).work.id;
  await studio.made(() => page.selectOption("#open-files", { label: "other/leaves.png" }));
  assert.notEqual((await studio.state()).work.id, own);
  assert.deepEqual((await studio.state()).work.files, {});
  studio.faults = studio.faults.filter(fault => !/ERR_|Failed to load/.test(fault));
  await studio.stop();
}

/** Categories renamed, merged, filled by hand and left out, with undo; they are in the library, the scene and the SVG. */
async function categories() {
  const studio = await smallLeaves();
  const { page } = studio;
  await studio.tab("change");
  await studio.made(async () => {
    await page.selectOption("#operation", "tint");
    await page.fill("#word-colour", "#ff0000");
    await page.press("#word-colour", "Tab");
    await page.selectOption("#which", "category:3");
    await page.click("#change >> text=Add >> nth=-1");
  });
  const tint = async () => (await studio.state()).work.operations[0];
  assert.equal(await tint(), "tint #ff0000 --where category=3");
  await studio.tab("mend");
  const shown = async () => {
    const { names, categories } = await page.evaluate(async () => (await fetch("api/elements")).json());
    await page.waitForFunction(names => JSON.stringify([...document.querySelectorAll("#mend input.name")].map(input => input.value)) === names, JSON.stringify(names));
    return { names, counts: names.map((_, k) => categories.filter(category => category === k).length), categories };
  };
  const found = await shown();
  assert.ok(found.names.length > 3, `${found.names}`);
  const rename = name => studio.made(async () => { await page.fill("[data-key=name-1]", name); await page.keyboard.press("Enter"); });
  await rename("Möwe-2 a");
  const renamed = await shown();
  assert.deepEqual(renamed.names, found.names.with(1, "Möwe-2 a"));
  assert.deepEqual(renamed.counts, found.counts);
  // Two become one, which has the name of the first; what was set by number follows.
  await page.check("[data-key=category-0]");
  await page.check("[data-key=category-1]");
  await studio.picture("categories");
  await studio.accessible("categories");
  await studio.made(() => page.click("[data-key=merge-categories]"));
  const merged = await shown();
  assert.deepEqual(merged.names, found.names.toSpliced(1, 1));
  assert.equal(merged.counts[0], found.counts[0] + found.counts[1]);
  assert.equal(await tint(), "tint #ff0000 --where category=2");
  await studio.made(() => page.click("#undo"));
  assert.deepEqual((await shown()).names, renamed.names);
  assert.equal(await tint(), "tint #ff0000 --where category=3");
  await studio.made(() => page.click("#redo"));
  // One element, clicked, into a new category, which gets a name.
  const places = await studio.elements();
  const one = merged.categories.findIndex((category, element) => category === 0 && element > 5);
  await page.mouse.click(...await studio.at(...places[one]));
  await studio.made(() => page.click("[data-key=move]"));
  const moved = await shown();
  assert.deepEqual([moved.names.at(-1), moved.counts.at(-1), moved.categories[one]], ["new", 1, moved.names.length - 1]);
  await studio.made(async () => { await page.fill(`[data-key=name-${moved.names.length - 1}]`, "the one"); await page.keyboard.press("Tab"); });
  // It is taken over by all that is saved.
  const { command, saved } = await studio.same("svg");
  assert.match(command, /--masks leaves\.masks\.json/);
  assert.match(String(saved), new RegExp(`\\(${merged.names[0]}\\)`));
  const names = [...merged.names, "the one"];
  const library = JSON.parse((await studio.same("library")).saved);
  assert.deepEqual(library.categories.map(({ name }) => name), names);
  assert.deepEqual(library.categories.map(({ members }) => members), moved.counts);
  const scene = JSON.parse((await studio.same("scene")).saved);
  assert.deepEqual(scene.libraries[0].categories, names);
  // One is left out of the synthesis, and its name follows.
  await studio.tab("change");
  const out = names[0];
  await studio.made(() => page.click(`[data-key="out-${out}"]`));
  const { work } = await studio.state();
  assert.ok(work.texture.elements > 0 && !work.texture.categories.some(({ name }) => name === out));
  assert.equal(await page.getAttribute(`[data-key="out-${out}"]`, "aria-pressed"), "true");
  await studio.tab("mend");
  await studio.made(async () => { await page.fill("[data-key=name-0]", "dark one"); await page.keyboard.press("Enter"); });
  const without = await studio.same("svg");
  assert.match(without.command, /'--exclude=dark one'/);
  await studio.picture("left-out");
  // An element deleted keeps the others' categories, after a restart too.
  await studio.tab("mend");
  const before = await shown();
  await page.mouse.click(...await studio.at(...(await studio.elements())[0]));
  await studio.made(() => page.keyboard.press("Delete"));
  assert.deepEqual((await shown()).categories, before.categories.slice(1));
  const last = (await studio.same("svg")).saved;
  await studio.kill();
  studio.faults = studio.faults.filter(fault => !/ERR_|Failed to load/.test(fault));
  await studio.run(["leaves.png"]);
  await studio.finished();
  assert.ok((await studio.same("svg")).saved.equals(last));
  // A comma is refused; found anew, they are as they were.
  await studio.tab("mend");
  await page.fill("[data-key=name-0]", "a, b");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".notice.fault");
  assert.match(await page.textContent(".notice.fault"), /letters, digits/);
  await page.click(".notice.fault button");
  await studio.made(() => page.click("[data-key=find-categories]"));
  assert.ok(!(await shown()).names.includes("the one"));
  studio.faults = studio.faults.filter(fault => !/ERR_|Failed to load|status of 422/.test(fault));
  await studio.stop();
}

/** Long work is told and can be stopped. */
async function stopped() {
  const studio = await Studio.start(folder("pebbles.png"), ["pebbles.png"]);
  const { page } = studio;
  await page.waitForFunction(() => /…$/.test(document.querySelector("#stage").textContent));
  await page.click("#cancel");
  await page.waitForFunction(() => document.querySelector("#stage").textContent === "Stopped");
  assert.ok(await page.isDisabled("#save-now"));
  await studio.made(() => page.click("#resume"));
  await page.focus("#canvas");
  const zoom = async () => { await page.waitForTimeout(100); return (await studio.seen()).zoom; };
  const before = await zoom();
  await page.keyboard.press("+");
  assert.ok(await zoom() > before);
  await page.keyboard.press("0");
  assert.equal(await zoom(), before);
  await studio.stop();
}

/** On a telephone every view and tool can be reached, at rest and while it works, and nothing sticks out to the right. */
async function telephone() {
  const viewport = { width: 390, height: 844 };
  const studio = await Studio.start(folder("terrazzo.png"), ["--seed", "3", "terrazzo.png"], { viewport });
  const { page } = studio;
  await studio.finished();
  // The widest that the page becomes, frame by frame, and what sticks out then.
  await page.evaluate(() => {
    window.widest = [0, ""];
    const look = () => {
      const { scrollWidth } = document.documentElement;
      if (scrollWidth > window.widest[0]) {
        const out = [...document.body.querySelectorAll("*")].filter(own => own.getBoundingClientRect().right > innerWidth + 0.5);
        window.widest = [scrollWidth, out.map(own => `${own.tagName}#${own.id}.${own.className}`).slice(-3).join(" ")];
      }
      requestAnimationFrame(look);
    };
    look();
  });
  for (const name of ["photograph", "elements", "redrawn", "texture", "split"]) {
    await page.click(`label:has([name=view][value=${name}])`);
    assert.ok(await page.isChecked(`[name=view][value=${name}]`));
  }
  const box = selector => page.$eval(selector, own => { const { left, top, right, bottom } = own.getBoundingClientRect(); return { left, top, right, bottom }; });
  const [slider, views, canvas] = [await box("#split"), await box("#views"), await box("#canvas")];
  assert.ok(slider.left >= 0 && slider.right <= viewport.width, "Split can be moved");
  assert.ok(views.bottom - views.top <= (canvas.bottom - canvas.top) / 3, "the views leave the picture free");
  await studio.picture("telephone");
  await studio.accessible("telephone");
  await studio.tab("steer");
  await studio.made(() => page.click("text=New seed"));
  for (const name of ["mend", "change", "save"]) await studio.tab(name);
  assert.deepEqual(await page.evaluate(() => window.widest), [viewport.width, ""]);
  await studio.stop();
}

/** The pictures of the documentation, by name only: tests/studio/run docs/images documentation */
async function documentation() {
  const studio = await Studio.start(folder("terrazzo.png"), ["--seed", "3", "terrazzo.png"], { viewport: { width: 1280, height: 800 } });
  const { page } = studio;
  await studio.finished();
  await page.fill("#knob-size", "900");
  await studio.made(async () => { await page.fill("[aria-label='Height of the canvas']", "760"); await page.keyboard.press("Tab"); });
  await page.click("text=Variants");
  await page.waitForFunction(() => document.querySelectorAll(".variants img").length === 6, null, { timeout: LONG });
  await page.waitForFunction(() => [...document.querySelectorAll(".variants img")].every(image => image.naturalWidth > 0));
  await studio.photograph("studio");
  await studio.tab("mend");
  const places = await studio.elements();
  for (const [index, place] of [places[100], places[101]].entries()) {
    if (index) await page.keyboard.down("Shift");
    await page.mouse.click(...await studio.at(...place));
  }
  await page.keyboard.up("Shift");
  await studio.photograph("studio-mend");
  await studio.stop();
}

try {
  // Parts by name, or all but the pictures of the documentation.
  const named = process.argv.slice(2);
  const parts = [photograph, others, painted, categories, stopped, telephone, documentation];
  for (const part of parts.filter(part => named.length ? named.includes(part.name) : part !== documentation)) {
    const began = Date.now();
    await part();
    console.log(`${part.name}: ${((Date.now() - began) / 1000).toFixed(0)} s`);
  }
  console.log("the studio works by clicking");
} finally {
  for (const made of folders) rmSync(made, { recursive: true, force: true });
}
