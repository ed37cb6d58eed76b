// The videos of the next trial alone, one after the other, once this one no longer needs the line.

import { say } from "./words.js";

const MOST_TRIES = 3;

export class FetchingAhead {
  constructor(addresses, place) {
    this.addresses = addresses;
    this.tries = 0;
    this.busy = false; // or done
    this.state = document.createElement("span");
    this.state.id = "ahead";
    place.after(this.state);
  }

  async begin() {
    if (this.busy || !this.addresses.length || this.tries === MOST_TRIES) return;
    this.busy = true;
    this.tries += 1;
    this.show(say("next page loading…"));
    try {
      for (const address of this.addresses) {
        const answer = await fetch(address, { priority: "low" });
        if (!answer.ok) throw new Error(answer.statusText);
        await answer.blob();
      }
      this.show(say("next page ready"));
    } catch {
      this.busy = false; // the next page fetches them itself
      this.show("");
    }
  }

  show(words) {
    this.state.textContent = words && ` · ${words}`;
  }
}
