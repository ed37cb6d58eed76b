// Next: says what is missing, or saves and moves on. A click is never lost.

import { post } from "./sending.js";
import { say } from "./words.js";

export class Submission {
  constructor(answers, evidence, missing) {
    this.answers = answers;
    this.evidence = evidence;
    this.missing = missing;
    this.form = answers.form;
    this.button = this.form.querySelector("#next");
    this.saved = document.getElementById("saved");
    this.problem = document.getElementById("problem");
    this.needed = document.getElementById("needed");
    this.busy = false;
    evidence.addEventListener("lost", () => {
      if (this.busy) this.showLost();
    });
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (!this.busy) this.submit();
    });
  }

  async submit() {
    if (this.missing().length) {
      this.needed.classList.remove("asked");
      void this.needed.offsetWidth; // lets the emphasis start anew
      this.needed.classList.add("asked");
      this.answers.focusFirstUnanswered();
      return;
    }
    this.begin();
    await this.evidence.report();
    await this.send();
  }

  // From here on nothing else can be sent.
  begin() {
    this.busy = true;
    this.button.setAttribute("aria-busy", "true");
    this.needed.textContent = say("Saving…");
    this.show(say("saving…"), "");
  }

  async send() {
    const { ok, status, next, problem } = await post(this.form, new FormData(this.form), () => this.showLost());
    if (ok) {
      this.answers.forget();
      this.show(say("saved ✓"), "");
      location.replace(next);
    } else if (status === 422) this.stay(problem);
    else location.reload();
  }

  stay(problem) {
    this.busy = false;
    this.button.removeAttribute("aria-busy");
    this.show("", problem);
    this.answers.dispatchEvent(new Event("change"));
  }

  showLost() {
    this.show(
      say("not saved yet"),
      say("The connection is lost. Your answers are kept here, and we are trying again… If this lasts, please switch ad blockers off for this page."),
    );
  }

  show(saved, problem) {
    this.saved.textContent = saved && ` · ${saved}`;
    this.problem.textContent = problem;
    this.problem.hidden = !problem;
    if (problem) this.problem.scrollIntoView({ block: "nearest" });
  }
}
