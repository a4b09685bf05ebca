// Everything put together, once and whenever another exemplar is chosen.

function show() {
  makeSummary();
  makeNotes();
  makePanes();
  makeSlider();
  makeLayers();
  makeCategories().catch(fail);
  makePlots();
  makeBackground();
  makeFacts();
}

function makeTheme() {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : dark.matches);
  const name = () => {
    byId("theme").textContent = isDark() ? "Light" : "Dark";
    byId("theme").setAttribute("aria-label", `Switch to ${isDark() ? "light" : "dark"} colours`);
    showSurroundings().catch(fail);
  };
  byId("theme").addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    name();
  });
  dark.addEventListener("change", name);
  name();
}

function makeNavigation() {
  for (const head of document.querySelectorAll("main > section > h2")) {
    byId("sections").append(el("a", { href: `#${head.parentElement.id}` }, head.textContent));
  }
  const select = byId("group");
  data.groups.forEach((g, i) => select.append(el("option", { value: i }, g.library?.name ?? g.file)));
  byId("choose").hidden = data.groups.length < 2;
  select.addEventListener("change", () => {
    state.group = Number(select.value);
    show();
  });
}

window.addEventListener("error", (event) => fail(event.error ?? event.message));
try {
  makeNavigation();
  makeTheme();
  listenToSlider();
  listenToZoom();
  show();
} catch (error) {
  fail(error);
}
