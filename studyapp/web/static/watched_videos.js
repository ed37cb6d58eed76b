// The watch evidence of all videos of a trial, and what of them is still missing in words.

import { WatchEvidence } from "./watch_evidence.js";
import { listed, say } from "./words.js";

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
    if (!labels[0]) return say("play the pair to the end");
    return say("watch {videos}", { videos: listed(labels) });
  }

  get words() {
    if (this.missing > 0 && this.unwatched.some((evidence) => evidence.silent)) {
      return say("Turn the sound on, please");
    }
    const [first] = this.each;
    if (!first.label) {
      if (first.missing <= 0) return say("Watched ✓");
      return say("Watched: still {seconds} s", { seconds: Math.ceil(first.missing) });
    }
    return say("Watched: {videos}", { videos: this.each.map(state).join(" · ") });
  }

  async report() {
    await Promise.all(this.each.map((evidence) => evidence.report()));
  }
}

function state({ label, missing }) {
  if (missing <= 0) return `${label} ✓`;
  return say("{video} – still {seconds} s", { video: label, seconds: Math.ceil(missing) });
}
