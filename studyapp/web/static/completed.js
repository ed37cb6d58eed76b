// Copying the completion code. Whoever comes next to this window is somebody else.

import { forget } from "./storage.js";

forget("visit");
const button = document.getElementById("copy");
const copied = document.getElementById("copied");
button.hidden = false;
button.addEventListener("click", async () => {
  const code = document.getElementById("completion-code");
  try {
    await navigator.clipboard.writeText(code.textContent);
    copied.textContent = "Copied ✓";
  } catch {
    getSelection().selectAllChildren(code);
    copied.textContent = "Marked: press Ctrl+C to copy";
  }
});
