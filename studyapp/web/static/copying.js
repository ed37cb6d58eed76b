/* Links in full, each with a button that copies it. */

for (const copied of document.querySelectorAll(".copied")) {
  const [link, button] = [copied.querySelector("a"), copied.querySelector("button")];
  link.textContent = link.href;
  // Browsers have no clipboard where a page came unencrypted from another machine.
  button.hidden = !navigator.clipboard;
  button.addEventListener("click", async () => {
    await navigator.clipboard.writeText(link.href);
    button.textContent = "Copied";
  });
}
