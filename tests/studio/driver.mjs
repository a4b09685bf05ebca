// Starting the program and a browser, and what tests do with the page.

import { execFileSync, spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import assert from "node:assert/strict";
import { chromium } from "playwright-core";

const { VTEX, BROWSER, PICTURES } = process.env;
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
/** How long anything may take, on a slow or busy machine. */
export const LONG = 180_000;

function run(line, folder) {
  const path = `${dirname(VTEX)}:${process.env.PATH}`;
  execFileSync("sh", ["-ec", line], { cwd: folder, env: { ...process.env, PATH: path }, stdio: "pipe" });
}

/** Libraries that analyses have made, by their command line and the files that it names. */
const libraries = new Map();

/** Runs a line if it is an analysis, unless the same was run before on the same files: then its library is copied. */
function analysed(line, folder) {
  const [, library] = /^vtex analyze .*-o (\S+)/.exec(line) ?? [];
  if (!library) return false;
  const sums = line.split(" ").slice(2).filter(word => word !== library && existsSync(join(folder, word)))
    .map(word => createHash("sha256").update(readFileSync(join(folder, word))).digest("hex"));
  const key = [line, ...sums].join(" ");
  if (libraries.has(key)) writeFileSync(join(folder, library), libraries.get(key));
  else {
    run(line, folder);
    libraries.set(key, readFileSync(join(folder, library)));
  }
  return true;
}

/** The file that a copied command makes, run in a copy of a folder, so that results do not mix with what is worked on. */
export function madeBy(command, from, name) {
  const folder = mkdtempSync(join(tmpdir(), "vtex-studio-"));
  try {
    execFileSync("cp", ["-r", `${from}/.`, folder]);
    for (const line of command.split("\n")) analysed(line, folder) || run(line, folder);
    return readFileSync(join(folder, name));
  } finally { rmSync(folder, { recursive: true }); }
}

/** The program, started in a folder, and the address of its page. */
export async function started(folder, files) {
  const program = spawn(VTEX, ["studio", "--no-open", ...files], { cwd: folder });
  process.on("exit", () => program.kill("SIGKILL"));
  const address = await new Promise((found, failed) => {
    let said = "";
    program.stderr.on("data", data => { said += data; const at = /http:\S+/.exec(said); if (at) found(at[0]); });
    program.on("exit", () => failed(new Error(`the program ended: ${said}`)));
  });
  return { program, address };
}

/** A folder, the program in it, and a page that is open in a browser. */
export class Studio {
  static async start(folder, files = [], { viewport = { width: 1280, height: 720 }, ...options } = {}) {
    const studio = new Studio();
    studio.folder = folder;
    studio.browser = await chromium.launch({ executablePath: BROWSER, args: ["--no-sandbox"] });
    studio.context = await studio.browser.newContext({ viewport, acceptDownloads: true, permissions: ["clipboard-read", "clipboard-write"], ...options });
    studio.page = await studio.context.newPage();
    studio.faults = [];
    studio.page.on("pageerror", error => studio.faults.push(error.message));
    studio.page.on("console", message => { if (message.type() === "error") studio.faults.push(message.text()); });
    await studio.run(files);
    return studio;
  }

  /** Starts the program and opens its page. */
  async run(files) {
    const { program, address } = await started(this.folder, files);
    this.program = program;
    await this.page.goto(address);
  }

  async kill() {
    const ended = new Promise(done => this.program.on("exit", done));
    this.program.kill("SIGKILL");
    await ended;
  }

  async stop() {
    assert.deepEqual(this.faults, []);
    await this.browser.close();
    const ended = new Promise(done => this.program.on("exit", done));
    this.program.kill("SIGINT");
    assert.equal(await ended, 0, "Ctrl-C ends the studio as usual");
  }

  state() {
    return this.page.evaluate(async () => (await fetch("api/state")).json());
  }

  /** Waits until the state is as it should be. */
  async until(holds) {
    const end = Date.now() + LONG;
    while (!holds(await this.state())) {
      if (Date.now() > end) {
        const told = await this.page.textContent("#notices");
        throw new Error(`the state does not become so: ${holds}; the page says: ${told || "nothing"}`);
      }
      await new Promise(done => setTimeout(done, 40));
    }
  }

  /** Waits until the texture is whole, and drawn. */
  async finished() {
    await this.until(({ work, busy }) => !busy && work?.texture && !work.texture.draft);
    const { work } = await this.state();
    await this.page.waitForFunction(drawn => document.body.dataset.drawn === drawn, `${work.id} ${work.texture.number}`, { timeout: LONG });
  }

  /** Waits for a whole texture, after something that changes it. */
  async made(action) {
    const { id, texture } = (await this.state()).work ?? {};
    const isNew = work => work?.texture && !work.texture.draft && (work.id !== id || work.texture.number > (texture?.number ?? 0));
    const began = Date.now();
    await action();
    await this.until(({ work, busy, fault }) => fault || (!busy && isNew(work)));
    const seconds = (Date.now() - began) / 1000;
    const state = await this.state();
    assert.equal(state.fault, null);
    const drawn = `${state.work.id} ${state.work.texture.number}`;
    await this.page.waitForFunction(drawn => document.body.dataset.ready === "true" && document.body.dataset.drawn === drawn, drawn, { timeout: LONG });
    return seconds;
  }

  /** Seconds until a draft of a new texture is seen, and until the whole one is. */
  async drafted(action) {
    const { number } = (await this.state()).work.texture;
    const begun = await this.page.evaluate(() => performance.now());
    const seen = this.page.evaluate(number => new Promise(done => {
      const look = () => (Number(document.body.dataset.drawn?.split(" ")[1]) > number ? done(performance.now()) : requestAnimationFrame(look));
      look();
    }), number);
    const whole = await this.made(action);
    return [(await seen - begun) / 1000, whole];
  }

  tab(name) {
    return this.page.click(`#tab-${name}`);
  }

  view(name) {
    return this.page.check(`[name=view][value=${name}]`, { force: true });
  }

  /** Saves a format, and runs the copied command: both are the same bytes. */
  async same(format, { scale } = {}) {
    await this.tab("save");
    await this.page.check(`[name=format][value=${format}]`);
    if (scale) { await this.page.fill("#scale", String(scale)); await this.page.press("#scale", "Tab"); }
    await this.page.waitForTimeout(250);
    const [download] = await Promise.all([this.page.waitForEvent("download"), this.page.click("#save-file")]);
    const saved = readFileSync(await download.path());
    await this.page.click("#copy");
    const command = await this.page.evaluate(() => navigator.clipboard.readText());
    assert.equal(command, await this.page.textContent("#lines"));
    const made = madeBy(command, this.folder, download.suggestedFilename());
    assert.ok(made.equals(saved), `${format}: ${saved.length} bytes were saved, ${made.length} made by:\n${command}`);
    return { command, saved };
  }

  /** Nothing that keeps people out. */
  async accessible(what) {
    await this.page.evaluate(AXE);
    const { violations } = await this.page.evaluate(() => window.axe.run());
    const told = violations.map(({ id, nodes }) => `${id}: ${nodes.map(node => node.html).join(" ")}`);
    assert.deepEqual(told, [], what);
  }

  async picture(name) {
    await this.page.waitForTimeout(350);
    if (PICTURES) await this.page.screenshot({ path: join(PICTURES, `${name}.png`) });
  }

  /** A picture for the documentation, of no more than 120 kB. */
  async photograph(name) {
    assert.ok(PICTURES, "name the folder of the pictures");
    await this.page.waitForTimeout(500);
    for (let quality = 88; ; quality -= 4) {
      const picture = await this.page.screenshot({ type: "jpeg", quality });
      if (picture.length <= 120_000) return writeFileSync(join(PICTURES, `${name}.jpg`), picture);
    }
  }

  /** A place of the photograph on the screen. */
  async at(x, y) {
    const box = await this.page.locator("#canvas").boundingBox();
    const { zoom, left, top } = await this.seen();
    return [box.x + left + x * zoom, box.y + top + y * zoom];
  }

  /** What the canvas shows: zoom, the place of the picture, the number of elements. */
  seen() {
    return this.page.$eval("#canvas", canvas => Object.fromEntries(Object.entries(canvas.dataset).map(([name, value]) => [name, Number(value)])));
  }

  /** A place within each element, once as many are shown as there are. */
  async elements() {
    const { places } = await this.page.evaluate(async () => (await fetch("api/elements")).json());
    await this.page.waitForFunction(count => Number(document.querySelector("#canvas").dataset.elements) === count, places.length);
    return places;
  }
}
