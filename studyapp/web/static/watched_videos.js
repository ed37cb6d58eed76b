// The watch evidence of all videos of a trial, and what of them is still missing in words.

import { WatchEvidence } from "./watch_evidence.js";
import { listed, say, sayCount } from "./words.js";

const LISTED = 3; // more of them are counted

export class WatchedVideos extends EventTarget {
  constructor(videos, stalls) {
    super();
    this.each = videos.map((video) => new WatchEvidence(video, stalls.get(video)));
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
    if (labels.length > LISTED) return sayCount("watch {count} video", "watch {count} videos", labels.length);
    return say("watch {videos}", { videos: listed(labels) });
  }

  // What keeps playing from counting; nothing where nothing does.
  get why() {
    const reasons = this.unwatched.map(({ why }) => why);
    if (reasons.includes("silent")) return say("Please turn the sound on");
    if (reasons.includes("hidden")) return say("Please keep the video in view while it plays");
    if (reasons.includes("fast")) return say("Please let the video play at normal speed");
    return "";
  }

  get words() {
    if (this.why) return this.why;
    if (!this.unwatched.length) return say("Watched ✓");
    return say("Still to watch: {videos}", { videos: this.unwatched.map(rest).join(" · ") });
  }

  async report() {
    await Promise.all(this.each.map((evidence) => evidence.report()));
  }
}

// Seconds only where they tell something: six of them would need a second line.
function rest({ label, missing, needed }) {
  const seconds = Math.ceil(missing);
  if (!label) return say("{seconds} s", { seconds });
  return missing < needed ? say("{video} {seconds} s", { video: label, seconds }) : label;
}
