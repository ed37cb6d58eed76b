// A page asks for itself anew while somebody can see it, and changes only what it shows.

import { writeLocalTimes } from "./local_times.js";

const live = document.getElementById("live");

/** Tell whether somebody is about to use what would be replaced. */
function inUse() {
  return live.contains(document.activeElement) || !document.getSelection().isCollapsed;
}

export async function refresh() {
  if (document.hidden || inUse()) {
    return;
  }
  let answer;
  try {
    answer = await fetch(live.dataset.address, { redirect: "manual" });
  } catch {
    return; // the server is away for a moment
  }
  if (answer.type === "opaqueredirect") {
    location.reload(); // the login has expired
    return;
  }
  if (!answer.ok) {
    return;
  }
  const page = new DOMParser().parseFromString(await answer.text(), "text/html");
  const fresh = page.getElementById("live");
  if (fresh !== null && !inUse()) {
    writeLocalTimes(fresh);
    live.replaceChildren(...fresh.childNodes);
    live.dataset.seconds = fresh.dataset.seconds;
  }
}

/** Refresh again and again, as often as the page says; 0 is never. */
function goOn() {
  const seconds = Number(live.dataset.seconds);
  if (seconds > 0) {
    setTimeout(() => refresh().finally(goOn), seconds * 1000);
  }
}

goOn();
