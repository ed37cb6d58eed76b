/* A study file in a text field: the line of the cursor, and links that lead to a line. */

const field = document.getElementById("text");
const where = document.getElementById("where");

function sayLine() {
  const line = field.value.slice(0, field.selectionStart).split("\n").length;
  where.textContent = `Line ${line} of ${field.value.split("\n").length}`;
}

function select(number) {
  const lines = field.value.split("\n");
  const start = lines.slice(0, number - 1).join("\n").length + (number > 1 ? 1 : 0);
  field.focus({ preventScroll: true });
  field.setSelectionRange(start, start + lines[number - 1].length);
  const height = parseFloat(getComputedStyle(field).lineHeight);
  field.scrollTop = (number - 1) * height - field.clientHeight / 4;
  sayLine();
}

document.addEventListener("selectionchange", sayLine);
field.addEventListener("input", sayLine);
for (const link of document.querySelectorAll("[data-line]")) {
  link.addEventListener("click", (event) => {
    event.preventDefault();
    select(Number(link.dataset.line));
    if (field.getBoundingClientRect().top + field.clientHeight / 4 > innerHeight) {
      field.scrollIntoView();
    }
  });
}
const first = document.querySelector("[data-line]");
if (first) {
  // The page stays where it says what is wrong.
  select(Number(first.dataset.line));
}
