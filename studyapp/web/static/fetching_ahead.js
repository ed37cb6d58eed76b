// The videos of the next trial alone, one after the other, once this one no longer needs the line.

import { say } from "./words.js";

export class FetchingAhead {
  constructor(addresses, place) {
    this.addresses = addresses;
    this.begun = false;
    this.state = document.createElement("span");
    this.state.id = "ahead";
    place.after(this.state);
  }

  async begin() {
    if (this.begun || !this.addresses.length) return;
    this.begun = true;
    this.show(say("next page loading…"));
    try {
      for (const address of this.addresses) {
        const answer = await fetch(address, { priority: "low" });
        await answer.blob();
      }
      this.show(say("next page ready"));
    } catch {
      this.begun = false;
      this.show("");
    }
  }

  show(words) {
    this.state.textContent = words && ` · ${words}`;
  }
}
