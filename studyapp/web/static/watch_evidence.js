// Which parts of a video were really played, and how. The server judges; here it is measured,
// and shown before the server has answered.

import { WatchReports } from "./watch_reports.js";

const REPORT_EVERY_MS = 2000;
const FASTEST = 1.05; // up to this rate it is played as recorded
const SLACK = 0.3; // seconds by which a video's clock may run ahead of the computer's
const LATE_S = 1; // by so much a busy computer may tell late that a video plays

export class WatchEvidence extends EventTarget {
  constructor(video, stalls) {
    super();
    this.video = video;
    this.label = video.dataset.label;
    this.soundless = "soundless" in video.dataset; // it is meant to be seen without sound
    this.duration = Number(video.dataset.duration);
    this.needed = Number(video.dataset.coverage) * this.duration;
    this.reports = new WatchReports(video);
    this.run = null; // since when it has been playing in the same way
    this.rest = video.currentTime; // from where it goes on when it plays again
    this.uncounted = ""; // how it played last, where that did not count
    for (const name of ["play", "playing", "timeupdate"]) {
      video.addEventListener(name, () => this.look());
    }
    video.addEventListener("ended", () => this.close(true));
    for (const name of ["pause", "seeking", "waiting", "emptied"]) {
      video.addEventListener(name, () => this.close(false));
    }
    for (const name of ["volumechange", "ratechange"]) {
      video.addEventListener(name, () => this.turn());
    }
    document.addEventListener("visibilitychange", () => this.turn());
    stalls.addEventListener("stall", ({ detail }) => this.reports.addStall(detail.seconds));
    for (const name of ["change", "lost"]) {
      this.reports.addEventListener(name, () => this.dispatchEvent(new Event(name)));
    }
    setInterval(() => this.report(), REPORT_EVERY_MS);
    addEventListener("pagehide", () => {
      stalls.end();
      this.close(false);
      this.reports.keep();
      this.report();
    });
  }

  get missing() {
    const rest = this.needed - length(merged(this.reports.watched));
    return rest < 0.001 ? 0 : rest;
  }

  get silent() {
    return !this.soundless && (this.video.muted || this.video.volume === 0);
  }

  // Why playing does not count: "silent", "hidden" or "fast"; nothing where it does.
  get why() {
    return this.silent ? "silent" : this.uncounted;
  }

  // A video that nobody can see or hear, or that runs too fast, does not count as watched.
  get kind() {
    if (document.hidden) return "hidden";
    if (this.silent) return "silent";
    return this.video.playbackRate > FASTEST ? "fast" : "watched";
  }

  look() {
    if (this.run) this.extend(this.video.currentTime);
    else if (!this.video.paused && !this.video.seeking) this.begin();
  }

  // It goes on in another way.
  turn() {
    if (this.run) {
      this.extend(this.video.currentTime);
      this.open();
    }
    this.dispatchEvent(new Event("change"));
  }

  // What has played before this is told counts too.
  begin() {
    const late = this.video.currentTime - this.rest;
    this.open(late > 0 && late < LATE_S ? late : 0);
  }

  open(late = 0) {
    const here = { time: this.video.currentTime - late, at: performance.now() - 1000 * late };
    this.run = { kind: this.kind, rate: this.video.playbackRate, start: here, last: here };
  }

  close(atEnd) {
    if (this.run && !this.video.seeking) {
      this.extend(atEnd ? this.duration : this.video.currentTime);
    }
    this.run = null;
    this.rest = this.video.currentTime;
    if (atEnd) this.report();
  }

  // What was played since the last look.
  extend(time) {
    const { run } = this;
    const now = { time: Math.min(time, this.duration), at: performance.now() };
    const played = now.time - run.last.time;
    if (played > 0) {
      const speed = (now.time - run.start.time) / ((now.at - run.start.at) / 1000 + SLACK);
      // Whatever the rate is said to be, no more can be played than time has passed.
      const fast = run.kind === "watched" && speed > FASTEST;
      const kind = fast ? "fast" : run.kind;
      const seconds = (now.at - run.last.at) / 1000;
      this.reports.add(kind, run.last.time, now.time, seconds, fast ? speed : run.rate);
      this.uncounted = kind === "watched" ? "" : kind;
    }
    run.last = now;
    if (played > 0) this.dispatchEvent(new Event("change"));
  }

  async report() {
    await this.reports.report();
  }
}

// The union of parts of a video, each from and to in seconds.
function merged(intervals) {
  const union = [];
  for (const [from, to] of [...intervals].sort((a, b) => a[0] - b[0])) {
    const last = union[union.length - 1];
    if (last && from <= last[1]) last[1] = Math.max(last[1], to);
    else union.push([from, to]);
  }
  return union;
}

function length(intervals) {
  return intervals.reduce((sum, [from, to]) => sum + to - from, 0);
}
