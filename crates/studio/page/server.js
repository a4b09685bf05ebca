// Calls to the program that served this page.

import { forget, notice } from "./dom.js";

const address = (name, parameters) => {
  const query = parameters ? `?${new URLSearchParams(parameters)}` : "";
  return `api/${name}${query.replaceAll("+", "%20")}`;
};

async function answer(response) {
  if (response.ok) return response;
  let told = {};
  try { told = await response.json(); } catch { /* It has no words of its own. */ }
  throw Object.assign(new Error(told.error ?? `the program answered ${response.status}`), { hint: told.hint, status: response.status });
}

export async function ask(name, parameters, signal) {
  return answer(await fetch(address(name, parameters), { signal }));
}

export async function askJson(name, parameters) {
  return (await ask(name, parameters)).json();
}

/** Changes something; `false` if it was refused, which the user is told. */
export async function tell(name, content = {}, parameters = undefined) {
  const raw = content instanceof Blob || content instanceof ArrayBuffer;
  try {
    await answer(await fetch(address(name, parameters), { method: "POST", body: raw ? content : JSON.stringify(content) }));
    // What was refused before has been put right, or is wanted no more.
    forget("refused");
    return true;
  } catch (error) {
    notice(error.message, { hint: error.hint, fault: true, key: "refused" });
    return false;
  }
}

/** Listens to the program until the page is closed. */
export function listen({ changed, progress, connected }) {
  const events = new EventSource("api/events");
  events.addEventListener("open", () => { connected(true); changed(); });
  events.addEventListener("error", () => connected(false));
  events.addEventListener("changed", changed);
  events.addEventListener("progress", event => progress(JSON.parse(event.data)));
}
