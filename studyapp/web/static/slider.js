// A line to choose a number on. Nothing is chosen until it is touched; the number field beside it
// holds the answer, and works alone where there is no script.

const CHANGES = /^(Arrow(Left|Right|Up|Down)|Page(Up|Down)|Home|End)$/;

export function addSlider(part) {
  const field = part.querySelector("[type=number]");
  const bands = [...part.querySelectorAll("li")].map((band) => band.textContent.trim());
  const line = document.createElement("input");
  const { min, max } = field;
  Object.assign(line, { type: "range", min, max, step: 1 });
  line.setAttribute("aria-label", field.getAttribute("aria-label"));

  function show() {
    const chosen = field.value !== "" && field.validity.valid;
    const width = (max - min) / bands.length;
    const band = bands[Math.min(Math.floor((field.value - min) / width), bands.length - 1)];
    if (chosen) line.value = field.value;
    line.classList.toggle("untouched", !chosen);
    line.setAttribute("aria-valuetext", chosen ? `${field.value}, ${band}` : "nothing chosen yet");
  }

  function choose() {
    if (field.value === line.value) return;
    field.value = line.value;
    show();
    field.dispatchEvent(new Event("change", { bubbles: true }));
  }

  line.addEventListener("input", choose);
  // A press exactly where the line rests, or a key at its end, moves nothing but is an answer.
  line.addEventListener("click", choose);
  line.addEventListener("keyup", (event) => CHANGES.test(event.key) && choose());
  field.addEventListener("input", show);
  field.before(line);
  show();
}
