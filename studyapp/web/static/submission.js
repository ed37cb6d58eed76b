// Next: says what is missing, or saves and moves on. A click is never lost.

import { say } from "./words.js";

const FIRST_WAIT_MS = 1000;
const LONGEST_WAIT_MS = 15000;

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
    this.busy = true;
    this.button.setAttribute("aria-busy", "true");
    this.needed.textContent = say("Saving…");
    this.show(say("saving…"), "");
    await this.evidence.report();
    await this.send();
  }

  async send() {
    for (let wait = FIRST_WAIT_MS; ; wait = Math.min(2 * wait, LONGEST_WAIT_MS)) {
      try {
        // Not `form.action`: a question of that name would hide it.
        const answer = await fetch(this.form.getAttribute("action"), {
          method: "POST",
          headers: { Accept: "application/json" },
          body: new URLSearchParams(new FormData(this.form)),
        });
        if (answer.ok) {
          this.answers.forget();
          this.show(say("saved ✓"), "");
          location.replace((await answer.json()).next);
          return;
        }
        if (answer.status < 500) {
          const { problem } = await answer.json();
          if (answer.status === 422) this.stay(problem);
          else location.reload();
          return;
        }
      } catch {
        // Told below; the answers stay on the page and in the draft.
      }
      this.showLost();
      await new Promise((resolve) => setTimeout(resolve, wait));
    }
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
      say("The connection is lost. Your answers are kept here, and we are trying again…"),
    );
  }

  show(saved, problem) {
    this.saved.textContent = saved && ` · ${saved}`;
    this.problem.textContent = problem;
    this.problem.hidden = !problem;
  }
}
