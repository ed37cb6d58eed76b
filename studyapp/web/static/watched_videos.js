// The watch evidence of all videos of a trial, and what of them is still missing in words.

import { WatchEvidence } from "./watch_evidence.js";

export class WatchedVideos extends EventTarget {
  constructor(videos) {
    super();
    this.each = videos.map((video) => new WatchEvidence(video));
    for (const evidence of this.each) {
      for (const name of ["change", "lost"]) {
        evidence.addEventListener(name, () => this.dispatchEvent(new Event(name)));
      }
    }
  }

  get missing() {
    return this.each.reduce((sum, evidence) => sum + evidence.missing, 0);
  }

  get unwatched() {
    return this.each.filter((evidence) => evidence.missing > 0);
  }

  // What a checklist says of them; nothing when all were watched.
  get needed() {
    const labels = this.unwatched.map(({ label }) => label);
    if (!labels.length) return "";
    return labels[0] ? `watch ${labels.join(", ")}` : "play the pair to the end";
  }

  get words() {
    if (this.missing > 0 && this.unwatched.some((evidence) => evidence.silent)) {
      return "Turn the sound on, please";
    }
    const [first] = this.each;
    if (!first.label) return `Watched${state(first).replace(/^ –/, ":")}`;
    return `Watched: ${this.each.map((each) => each.label + state(each)).join(" · ")}`;
  }

  async report() {
    await Promise.all(this.each.map((evidence) => evidence.report()));
  }
}

function state({ missing }) {
  return missing > 0 ? ` – still ${Math.ceil(missing)} s` : " ✓";
}
