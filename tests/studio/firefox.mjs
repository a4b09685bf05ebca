// The studio once in headless Firefox: opened, looked at, a knob turned, saved as the copied command would.

import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import assert from "node:assert/strict";
import puppeteer from "puppeteer-core";
import { madeBy, started } from "./driver.mjs";

const { EXEMPLARS, FIREFOX, PICTURES } = process.env;
const folder = mkdtempSync(join(tmpdir(), "vtex-studio-"));
const downloads = mkdtempSync(join(tmpdir(), "vtex-studio-"));
copyFileSync(join(EXEMPLARS, "leaves.png"), join(folder, "leaves.png"));

const { program, address } = await started(folder, ["leaves.png"]);
const browser = await puppeteer.launch({
  browser: "firefox", executablePath: FIREFOX, headless: true, defaultViewport: { width: 1280, height: 720 },
  extraPrefsFirefox: { "browser.download.dir": downloads, "browser.download.folderList": 2, "browser.download.useDownloadDir": true },
});
try {
  const page = await browser.newPage();
  const faults = [];
  page.on("pageerror", error => faults.push(error.message));
  page.on("console", message => { if (message.type() === "error") faults.push(message.text()); });
  const picture = name => PICTURES ? page.screenshot({ path: join(PICTURES, `firefox-${name}.png`) }) : undefined;
  const whole = async () => {
    const { work } = await (await fetch("api/state")).json();
    return work?.texture && !work.texture.draft ? work.texture.number : 0;
  };
  /** Waits for a whole texture after that of a number, drawn. */
  const wholeAfter = before => page.waitForFunction(async before => {
    const { work, busy } = await (await fetch("api/state")).json();
    return !busy && work.texture && !work.texture.draft && work.texture.number > before
      && document.body.dataset.ready === "true" && document.body.dataset.drawn === `${work.id} ${work.texture.number}`;
  }, { timeout: 120_000, polling: 100 }, before);
  const made = async action => {
    const before = await page.evaluate(whole);
    await action();
    await wholeAfter(before);
  };

  // Open: the photograph is seen, then the texture.
  await page.goto(address);
  await wholeAfter(0);
  await picture("texture");
  // Look: every view, by keys, and zoom.
  await page.focus("[name=view][value=texture]");
  for (const view of ["redrawn", "elements", "photograph"]) {
    await page.keyboard.press("ArrowLeft");
    assert.equal(await page.$eval("[name=view]:checked", input => input.value), view);
  }
  await page.focus("[name=view][value=photograph]");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => Number(document.querySelector("#canvas").dataset.elements) > 10);
  await picture("elements");
  const zoom = () => page.$eval("#canvas", canvas => Number(canvas.dataset.zoom));
  const before = await zoom();
  await page.focus("#canvas");
  await page.keyboard.press("+");
  await page.waitForFunction(before => Number(document.querySelector("#canvas").dataset.zoom) > before, {}, before);
  // A knob.
  await page.click("[name=view][value=texture]");
  await page.$eval("#knob-size", input => { input.value = ""; });
  await page.type("#knob-size", "320");
  await made(() => page.keyboard.press("Tab"));
  await made(() => page.select("#knob-tile", "both"));
  await picture("tile");
  // Save.
  await page.click("#tab-save");
  await page.waitForFunction(() => document.querySelector("#save-file").textContent.endsWith(".svg"));
  const [command, name] = await page.evaluate(() => [document.querySelector("#lines").textContent, document.querySelector("#save-file").textContent.slice(5)]);
  assert.match(command, /--size=320x\d+ --tile=both/);
  await page.click("#save-file");
  const saved = join(downloads, name);
  for (let tries = 0; !existsSync(saved) || !readFileSync(saved).length; tries++) {
    assert.ok(tries < 100, `${name} is not saved`);
    await new Promise(done => setTimeout(done, 100));
  }
  assert.ok(madeBy(command, folder, name).equals(readFileSync(saved)), command);
  await picture("save");
  assert.deepEqual(faults, []);
  console.log(`the studio works in Firefox (${await browser.version()})`);
} finally {
  await browser.close();
  program.kill("SIGINT");
  for (const made of [folder, downloads]) rmSync(made, { recursive: true, force: true });
}
