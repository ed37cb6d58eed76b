// Which parts of a video were really played. The server decides whether that is enough; here
// it is measured, reported in numbered batches, and shown before the server has answered.

import { forget, recall, remember } from "./storage.js";

const REPORT_EVERY_MS = 2000;
const RETRY_MS = 2000;
const SLACK = 0.3; // seconds by which a video's clock may run ahead of the computer's

export function merged(intervals) {
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

function covers(known, intervals) {
  return length(merged([...known, ...intervals])) - length(known) < 0.001;
}

export class WatchEvidence extends EventTarget {
  constructor(video) {
    super();
    this.video = video;
    this.label = video.dataset.label;
    this.soundless = "soundless" in video.dataset; // it is meant to be seen without sound
    this.duration = Number(video.dataset.duration);
    this.needed = Number(video.dataset.coverage) * this.duration;
    this.played = JSON.parse(video.dataset.watched);
    this.batch = Number(video.dataset.nextBatch);
    this.keptKey = `unsent ${video.dataset.watchedUrl}`;
    this.unsent = JSON.parse(recall(this.keptKey) ?? "[]");
    forget(this.keptKey);
    this.flying = [];
    this.last = null; // where the playing video was when last looked at, and when that was
    this.sending = null;
    for (const name of ["play", "playing", "timeupdate"]) {
      video.addEventListener(name, () => this.look());
    }
    video.addEventListener("ended", () => this.close(true));
    for (const name of ["pause", "seeking", "waiting"]) {
      video.addEventListener(name, () => this.close(false));
    }
    video.addEventListener("volumechange", () => {
      this.close(false);
      this.look();
      this.dispatchEvent(new Event("change"));
    });
    setInterval(() => this.report(), REPORT_EVERY_MS);
    addEventListener("pagehide", () => {
      this.close(false);
      this.keep();
      this.report();
    });
  }

  get missing() {
    const rest = this.needed - length(merged([...this.played, ...this.flying, ...this.unsent]));
    return rest < 0.001 ? 0 : rest;
  }

  get silent() {
    return !this.soundless && (this.video.muted || this.video.volume === 0);
  }

  // A video that nobody can see or hear does not count as watched.
  open() {
    if (document.hidden || this.silent) return;
    this.last = { time: this.video.currentTime, at: performance.now() };
  }

  look() {
    if (this.last !== null) this.extend(this.video.currentTime);
    else if (!this.video.paused && !this.video.seeking) this.open();
  }

  close(atEnd) {
    if (this.last !== null && !this.video.seeking) {
      this.extend(atEnd ? this.duration : this.video.currentTime);
    }
    this.last = null;
    if (atEnd) this.report();
  }

  // What was played since the last look: no more than time has passed.
  extend(time) {
    const now = { time: Math.min(time, this.duration), at: performance.now() };
    const played = now.time - this.last.time;
    if (played > 0 && played <= (now.at - this.last.at) / 1000 + SLACK) {
      this.add(this.last.time, now.time);
    }
    this.last = now;
  }

  add(from, to) {
    this.unsent = merged([...this.unsent, [from, to]]);
    this.dispatchEvent(new Event("change"));
  }

  // A page that is left may not learn whether its last report arrived: the next one sends it
  // again under the same number.
  keep() {
    const kept = merged([...this.flying, ...this.unsent]);
    if (kept.length) remember(this.keptKey, JSON.stringify(kept));
  }

  // Send what is unsent; resolves when nothing is, or when sending failed.
  async report() {
    while (this.sending) await this.sending;
    if (!this.unsent.length) return;
    this.sending = this.send();
    await this.sending;
    this.sending = null;
  }

  async send() {
    const intervals = this.unsent;
    this.unsent = [];
    this.flying = intervals;
    const body = JSON.stringify({ batch: this.batch, intervals });
    for (;;) {
      try {
        const answer = await fetch(this.video.dataset.watchedUrl, {
          method: "POST",
          headers: { "Content-Type": "application/json", Accept: "application/json" },
          body,
          keepalive: true,
        });
        if (answer.ok) {
          const known = await answer.json();
          this.played = known.intervals;
          this.batch = known.next_batch;
          this.flying = [];
          // Another window has used the number: once more under the next one.
          if (!covers(this.played, intervals)) this.unsent = merged([...this.unsent, ...intervals]);
          this.dispatchEvent(new Event("change"));
          return;
        }
        if (answer.status < 500) {
          // Another window has moved on: show where the participant stands.
          location.reload();
          return;
        }
      } catch {
        // The same report is sent again under the same number.
      }
      this.dispatchEvent(new Event("lost"));
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
  }
}
