// The reports of one video, in order. Each tells of one stretch of playing, all of it alike, and
// has a number: the server stores a number once, so that whatever may not have arrived is sent
// again. What a page could not send before it was left, the next one sends.

import { ANSWERED_MS } from "./sending.js";
import { forget, recall, remember } from "./storage.js";

const RETRY_MS = 2000;
const LONGEST_WAIT_MS = 5000; // whatever a proxy may ask for
const MOST_INTERVALS = 150; // the server takes 200

export class WatchReports extends EventTarget {
  constructor(video) {
    super();
    this.video = video;
    this.known = JSON.parse(video.dataset.watched); // what the server counts as watched
    this.next = Number(video.dataset.nextBatch);
    this.keptKey = `unsent ${video.dataset.watchedUrl}`;
    this.queue = JSON.parse(recall(this.keptKey) ?? "[]");
    forget(this.keptKey);
    this.sending = null;
    this.told = { frames: 0, dropped_frames: 0 };
  }

  // The intervals that count, as far as can be told before the server has answered.
  get watched() {
    const unsent = this.queue.filter(({ kind }) => kind === "watched");
    return [...this.known, ...unsent.flatMap(({ intervals }) => intervals)];
  }

  // What was played from one moment to the next.
  add(kind, from, to, seconds, rate) {
    const stretch = this.stretch(kind);
    const last = stretch.intervals[stretch.intervals.length - 1];
    if (last?.[1] === from) last[1] = to;
    else stretch.intervals.push([from, to]);
    stretch.rate = Math.max(stretch.rate, rate);
    if (kind === "hidden") stretch.hidden_seconds += seconds;
    if (kind === "silent") stretch.silent_seconds += seconds;
  }

  addStall(seconds) {
    const stretch = this.stretch();
    stretch.stalls += 1;
    stretch.stalled_seconds += seconds;
  }

  // The last report that is not under way yet; a new one where it is of another kind.
  stretch(kind) {
    const last = this.queue[this.queue.length - 1];
    const open = last && last.batch === undefined && last.intervals.length < MOST_INTERVALS;
    if (open && last.kind === (kind ?? last.kind)) return last;
    const made = {
      kind: kind ?? "watched",
      intervals: [],
      rate: 0,
      hidden_seconds: 0,
      silent_seconds: 0,
      stalls: 0,
      stalled_seconds: 0,
    };
    this.queue.push(made);
    return made;
  }

  // A page that is left may not learn whether its reports arrived: the next one sends them again
  // under the same numbers.
  keep() {
    for (const [place, stretch] of this.queue.entries()) {
      this.seal(stretch, place ? this.queue[place - 1].batch + 1 : this.next);
    }
    if (this.queue.length) remember(this.keptKey, JSON.stringify(this.queue));
  }

  // What has a number stays as it is.
  seal(stretch, number) {
    if (stretch.batch !== undefined) return;
    const quality = this.video.getVideoPlaybackQuality?.();
    this.count(stretch, "frames", quality?.totalVideoFrames);
    this.count(stretch, "dropped_frames", quality?.droppedVideoFrames);
    stretch.batch = number;
  }

  // The browser counts from when the video was loaded: what came since the last report is told.
  count(stretch, name, total) {
    if (total === undefined) return;
    const since = total < this.told[name] ? 0 : this.told[name];
    stretch[name] = (stretch[name] ?? 0) + total - since;
    this.told[name] = total;
  }

  // Send what is unsent; resolves when nothing is.
  async report() {
    while (this.sending) await this.sending;
    if (!this.queue.length) return;
    this.sending = this.sendAll();
    await this.sending;
    this.sending = null;
  }

  async sendAll() {
    while (this.queue.length) await this.send(this.queue[0]);
  }

  async send(stretch) {
    this.seal(stretch, this.next);
    const { kind, rate, ...report } = stretch;
    const body = JSON.stringify({ ...report, rate: rate || 1 });
    for (;;) {
      try {
        const answer = await fetch(this.video.dataset.watchedUrl, {
          method: "POST",
          headers: { "Content-Type": "application/json", Accept: "application/json" },
          body,
          keepalive: true,
          signal: AbortSignal.timeout?.(ANSWERED_MS),
        });
        if (answer.status === 429) {
          // Too many have come of late. It is sent again, and nobody needs to know.
          const seconds = Number(answer.headers.get("Retry-After"));
          await sleep(Math.min(1000 * seconds || RETRY_MS, LONGEST_WAIT_MS));
          continue;
        }
        // A page of something between here and the server is no answer.
        const known = await answer.json();
        if (answer.ok) {
          this.known = known.intervals;
          this.next = known.next_batch;
          // Another window has used the number: once more under the next one.
          if (known.stored) this.queue.shift();
          else delete stretch.batch;
          this.dispatchEvent(new Event("change"));
          return;
        }
        if (answer.status === 422) {
          // It proves nothing: the video has to be played again.
          this.queue.shift();
          this.dispatchEvent(new Event("change"));
          return;
        }
        if (answer.status < 500) {
          // Another window has moved on: show where the participant stands.
          this.queue = [];
          location.reload();
          return;
        }
      } catch {
        // The same report is sent again under the same number.
      }
      this.dispatchEvent(new Event("lost"));
      await sleep(RETRY_MS);
    }
  }
}

function sleep(milliseconds) {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}
