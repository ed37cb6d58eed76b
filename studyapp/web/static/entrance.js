// Before enrolment: the same window always starts the same study session, also after going back;
// and whoever comes with another device than the study wants is told so.

import { recall, remember } from "./storage.js";
import { say } from "./words.js";

const SMALLEST_SIDE = 600; // CSS pixels of a tablet
const AGAIN_MS = 5000; // sooner, a click is of the same answer

const entrance = document.getElementById("entrance");
const visit = entrance.querySelector("[name=visit]");
const stored = recall("visit");
if (stored) visit.value = stored;
else remember("visit", visit.value);

// Whoever cannot take part is counted, and has no name by which to be counted once.
let sentAt = -AGAIN_MS;
entrance.querySelector("form").addEventListener("submit", (event) => {
  if (event.timeStamp - sentAt < AGAIN_MS) event.preventDefault();
  else sentAt = event.timeStamp;
});
// A browser may show the page as it was when somebody goes back.
addEventListener("pageshow", () => {
  sentAt = -AGAIN_MS;
});

// What is touched, and how large it is. What the browser calls itself was the server's first guess.
function kindOfDevice() {
  if (!matchMedia("(pointer: coarse)").matches) return "computer";
  return Math.min(screen.width, screen.height) < SMALLEST_SIDE ? "phone" : "tablet";
}

const other = document.getElementById("other-device");
if (other) {
  other.hidden = other.dataset.devices.split(" ").includes(kindOfDevice());
  entrance.hidden = !other.hidden;
  const link = document.getElementById("link");
  const copied = document.getElementById("link-copied");
  link.value = location.href;
  document.getElementById("copy-link").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(link.value);
      copied.textContent = say("Copied ✓");
    } catch {
      link.focus();
      link.select();
      copied.textContent = say("Selected: you can copy it now");
    }
  });
}
