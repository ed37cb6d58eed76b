// Before enrolment: the same window always starts the same study session, also after going back;
// and a phone is told to come back as a computer, where the study wants that.

import { recall, remember } from "./storage.js";
import { say } from "./words.js";

const SMALLEST_SIDE = 600; // CSS pixels; on less, videos are too small to be judged

const entrance = document.getElementById("entrance");
const visit = entrance.querySelector("[name=visit]");
const stored = recall("visit");
if (stored) visit.value = stored;
else remember("visit", visit.value);

// What is touched and small. What the browser calls itself was only the server's first guess.
function isPhone() {
  const side = Math.min(screen.width, screen.height);
  return side < SMALLEST_SIDE && matchMedia("(pointer: coarse)").matches;
}

const phone = document.getElementById("phone");
if (phone) {
  phone.hidden = !isPhone();
  entrance.hidden = !phone.hidden;
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
