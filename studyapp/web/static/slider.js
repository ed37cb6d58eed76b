// A line to choose a number on. Nothing is chosen until it is touched; the number field beside it
// holds the answer, and works alone where there is no script.

import { say } from "./words.js";

const MOVES = /^(Arrow(Left|Right|Up|Down)|Page(Up|Down))$/;

function addSlider(part) {
  const field = part.querySelector("[type=number]");
  const bands = [...part.querySelectorAll("li")];
  const low = Number(field.min);
  const high = Number(field.max);
  const line = document.createElement("input");
  Object.assign(line, { type: "range", min: low, max: high, step: 1 });
  line.setAttribute("aria-label", field.getAttribute("aria-label"));

  const isChosen = () => field.value !== "" && field.validity.valid;

  function show() {
    const chosen = isChosen();
    const width = (high - low) / bands.length;
    const band = bands[Math.min(Math.floor((field.value - low) / width), bands.length - 1)];
    if (chosen) line.value = field.value;
    line.classList.toggle("untouched", !chosen);
    for (const each of bands) each.classList.toggle("chosen", chosen && each === band);
    const words = chosen
      ? say("{number}, {band}", { number: field.value, band: band.textContent.trim() })
      : say("nothing chosen yet");
    line.setAttribute("aria-valuetext", words);
  }

  function choose(number) {
    if (field.value === String(number)) return;
    field.value = number;
    show();
    field.dispatchEvent(new Event("change", { bubbles: true }));
  }

  line.addEventListener("input", () => choose(line.value));
  // A press exactly where the line rests moves nothing but is an answer.
  line.addEventListener("click", () => choose(line.value));
  // An untouched line has no place to move from: whatever the key, it begins in the middle.
  line.addEventListener("keydown", (event) => {
    if (isChosen()) return;
    if (MOVES.test(event.key)) choose(Math.round((low + high) / 2));
    else if (event.key === "Home") choose(low);
    else if (event.key === "End") choose(high);
    else return;
    event.preventDefault();
  });
  // Nor is there anything to take hold of: a touch chooses where it falls, in every browser.
  line.addEventListener("pointerdown", ({ clientX }) => {
    if (isChosen()) return;
    const { left, width } = line.getBoundingClientRect();
    const share = Math.min(Math.max((clientX - left) / width, 0), 1);
    choose(Math.round(low + share * (high - low)));
  });
  field.addEventListener("input", show);
  field.before(line);
  show();
}

for (const part of document.querySelectorAll(".slider")) addSlider(part);
