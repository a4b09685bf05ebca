// Uses the page as a person would and writes what happened into the document.
(async () => {
  const errors = [];
  window.addEventListener("error", (event) => errors.push(String(event.message)));
  window.addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
  document.addEventListener("securitypolicyviolation", (event) => errors.push("policy: " + event.blockedURI));
  const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  const all = (selector) => [...document.querySelectorAll(selector)];
  const settled = async () => {
    for (let i = 0; i !== 100; i++) {
      await wait(100);
      if (all(".pane").every((pane) => pane.querySelector("img")) && all(".card").length) break;
    }
    await wait(300);
  };
  // The picture that is shown last, as its pixels.
  const pixels = () => {
    const images = [...all(".pane").pop().querySelectorAll("img:not([hidden])")];
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = ["width", "height"].map((side) => parseFloat(all(".holder").pop().style[side]));
    const context = canvas.getContext("2d");
    images.forEach((image) => context.drawImage(image, 0, 0, canvas.width, canvas.height));
    return context.getImageData(0, 0, canvas.width, canvas.height).data;
  };
  const difference = (a, b) => a.reduce((sum, v, i) => sum + Math.abs(v - b[i]), 0) / a.length;
  const seen = { errors, changed: {} };
  try {
    await settled();
    seen.panes = all(".pane figcaption b").map((b) => b.textContent);
    const full = pixels();
    const press = async (button) => {
      button.click();
      await settled();
    };
    for (const button of [...all("[data-layer]"), document.querySelector(".switch[data-category]")]) {
      const before = button.getAttribute("aria-pressed");
      await press(button);
      seen.changed[button.dataset.layer ?? "category"] = difference(full, pixels());
      if (button.getAttribute("aria-pressed") === before) errors.push("a switch does not turn");
      await press(button);
    }
    seen.restored = difference(full, pixels());
    // Pixels of the last picture in the red of lines, and how many of these stay so without details;
    // blending rounds them by a step.
    const red = (p, i, steps) => [200, 30, 30].every((v, c) => Math.abs(p[i + c] - v) <= steps);
    const lined = pixels();
    await press(document.querySelector('[data-layer="details"]'));
    const bare = pixels();
    seen.lines = [0, 0];
    for (let i = 0; i !== lined.length; i += 4) {
      if (!red(lined, i, 0)) continue;
      seen.lines[0] += 1;
      if (red(bare, i, 2)) seen.lines[1] += 1;
    }
    await press(document.querySelector('[data-layer="details"]'));
    seen.edits = all(".edits li").length;
    const transforms = () => all(".holder").map((holder) => new DOMMatrix(getComputedStyle(holder).transform));
    if (seen.panes.length > 1) {
      await press(document.getElementById("over"));
      const handle = document.getElementById("handle");
      const value = () => Number(handle.getAttribute("aria-valuenow"));
      seen.slider = [value()];
      handle.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
      seen.slider.push(value());
      const box = document.getElementById("stage").getBoundingClientRect();
      handle.setPointerCapture = () => {};
      handle.hasPointerCapture = () => true;
      const at = { clientX: box.left + 0.75 * box.width, clientY: box.top + 50, pointerId: 1, bubbles: true };
      handle.dispatchEvent(new PointerEvent("pointermove", at));
      seen.slider.push(value());
      seen.clip = getComputedStyle(document.querySelector(".right .window")).clipPath;
      await press(document.getElementById("beside"));
    }
    const before = transforms()[0].a;
    for (let i = 0; i !== 8; i++) document.getElementById("in").click();
    seen.zoomed = transforms()[0].a / before;
    seen.scales = new Set(transforms().map((matrix) => matrix.a)).size;
    const place = transforms().map((matrix) => matrix.e);
    document.querySelector(".window").dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true }));
    seen.moved = Math.min(...transforms().map((matrix, i) => Math.abs(matrix.e - place[i])));
    document.getElementById("fit").click();
    const thumb = document.querySelector(".thumb");
    await press(thumb);
    seen.chosen = thumb.getAttribute("aria-pressed") === "true";
    const maps = all("#surroundings canvas");
    seen.maps = maps.length;
    if (maps.length) {
      const data = maps[0].getContext("2d").getImageData(0, 0, maps[0].width, maps[0].height).data;
      seen.mapColours = new Set(new Uint32Array(data.buffer)).size;
    }
    seen.plots = all(".plot svg").length;
    seen.wide = Math.max(0, document.documentElement.scrollWidth - document.documentElement.clientWidth);
    const colour = () => getComputedStyle(document.body).backgroundColor;
    seen.themes = [colour()];
    await press(document.getElementById("theme"));
    seen.themes.push(colour());
    if (!document.getElementById("failure").hidden) errors.push(document.getElementById("failure").textContent);
  } catch (error) {
    errors.push(String(error.stack));
  }
  const outcome = document.createElement("pre");
  outcome.id = "outcome";
  outcome.textContent = JSON.stringify(seen);
  document.body.append(outcome);
})();
