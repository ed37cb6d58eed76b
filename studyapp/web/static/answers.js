// The questions: keys 1-5, and a draft that outlives a reload.

import { isOrder, ranksOf } from "./order.js";
import { forget, recall, remember } from "./storage.js";

function answered(question) {
  const ranks = question.querySelector(".ranks");
  if (ranks) return isOrder(ranksOf(ranks), "ties" in ranks.dataset);
  const number = question.querySelector("[type=number]");
  if (number) return number.value !== "" && number.validity.valid;
  return question.querySelector("[type=radio]:checked") !== null;
}

export class Answers extends EventTarget {
  constructor(form) {
    super();
    this.form = form;
    this.questions = [...form.querySelectorAll(".question")];
    this.draftKey = `draft ${form.elements.trial.value}`;
    this.restore();
    form.addEventListener("change", () => {
      remember(this.draftKey, JSON.stringify(this.given()));
      this.dispatchEvent(new Event("change"));
    });
    document.addEventListener("keydown", (event) => this.key(event));
  }

  // Every answer as its name and value; a name may come several times.
  given() {
    return [...new FormData(this.form)].filter(([name]) => name !== "trial");
  }

  unanswered() {
    return this.open().map((question) => question.dataset.needed);
  }

  open() {
    return this.questions.filter((question) => !answered(question));
  }

  restore() {
    for (const [name, value] of JSON.parse(recall(this.draftKey) ?? "[]")) {
      for (const control of this.form.querySelectorAll(".question :is(input, select)")) {
        if (control.name !== name) continue;
        if (control.matches("select, [type=number]")) control.value = value;
        else if (control.value === value) control.checked = true;
      }
    }
  }

  forget() {
    forget(this.draftKey);
  }

  // 1-5 answer the question that has the focus, else the first unanswered one.
  key(event) {
    if (event.target.matches("[type=number], select, .card") || event.ctrlKey || event.metaKey || event.altKey || !/^[1-5]$/.test(event.key)) return;
    const focused = document.activeElement?.closest(".question");
    const question = focused ?? this.open()[0];
    const choice = question?.querySelectorAll("[type=radio]")[Number(event.key) - 1];
    if (!choice) return;
    choice.click();
    event.preventDefault();
  }

  focusFirstUnanswered() {
    const wanted = "[type=radio], [type=range], .tray .card, select";
    const controls = [...(this.open()[0]?.querySelectorAll(wanted) ?? [])];
    const seen = controls.filter((control) => control.getClientRects().length);
    (seen.find((control) => !control.matches("select") || !control.value) ?? seen[0])?.focus();
  }
}
