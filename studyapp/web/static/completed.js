// Copying the completion code. Whoever comes next to this window is somebody else.

import { forget } from "./storage.js";
import { say } from "./words.js";

forget("visit");
const button = document.getElementById("copy");
const copied = document.getElementById("copied");
button.hidden = false;
button.addEventListener("click", async () => {
  const code = document.getElementById("completion-code");
  try {
    await navigator.clipboard.writeText(code.textContent);
    copied.textContent = say("Copied ✓");
  } catch {
    getSelection().selectAllChildren(code);
    copied.textContent = say("Selected: press Ctrl+C to copy");
  }
});
