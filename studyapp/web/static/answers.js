// The questions: keys 1-5, and a draft that outlives a reload.

import { forget, recall, remember } from "./storage.js";

export class Answers extends EventTarget {
  constructor(form) {
    super();
    this.form = form;
    this.questions = [...form.querySelectorAll(".question")];
    this.draftKey = `draft ${form.elements.trial.value}`;
    this.restore();
    form.addEventListener("change", () => {
      remember(this.draftKey, JSON.stringify(this.values()));
      this.dispatchEvent(new Event("change"));
    });
    document.addEventListener("keydown", (event) => this.key(event));
  }

  values() {
    return Object.fromEntries(
      [...new FormData(this.form)].filter(([name]) => name !== "trial"),
    );
  }

  unanswered() {
    return this.open().map((question) => question.dataset.needed);
  }

  open() {
    return this.questions.filter((question) => !question.querySelector(":checked"));
  }

  restore() {
    const draft = JSON.parse(recall(this.draftKey) ?? "{}");
    for (const radio of this.form.querySelectorAll("[type=radio]")) {
      if (draft[radio.name] === radio.value) radio.checked = true;
    }
  }

  forget() {
    forget(this.draftKey);
  }

  // 1-5 answer the question that has the focus, else the first unanswered one.
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !/^[1-5]$/.test(event.key)) return;
    const focused = document.activeElement?.closest(".question");
    const question = focused ?? this.open()[0];
    if (!question) return;
    question.querySelectorAll("[type=radio]")[Number(event.key) - 1]?.click();
    event.preventDefault();
  }

  focusFirstUnanswered() {
    this.open()[0]?.querySelector("[type=radio]").focus();
  }
}
