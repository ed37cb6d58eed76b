// Notices when a video that is meant to play does not move, whatever its browser says about it.

const LOOK_EVERY_MS = 250;
const UNMOVED_MS = 1000; // without any event, this long at one place is a stall
const SHORTEST_S = 0.25; // jumping to another place takes a moment too
const PATIENCE_MS = 5000; // then the participant is told

export class Stalls extends EventTarget {
  constructor(video) {
    super();
    this.video = video;
    this.since = null; // when the stall began
    this.told = false;
    this.seen = { time: video.currentTime, at: performance.now() };
    video.addEventListener("play", () => this.move());
    video.addEventListener("waiting", () => {
      if (this.meant && !video.seeking) this.since ??= performance.now();
    });
    for (const name of ["pause", "ended", "emptied", "error"]) {
      video.addEventListener(name, () => this.end());
    }
    setInterval(() => this.look(), LOOK_EVERY_MS);
  }

  get meant() {
    return !this.video.paused && !this.video.ended && !this.video.error;
  }

  look() {
    const now = performance.now();
    if (this.video.currentTime !== this.seen.time) this.move();
    else if (this.meant && now - this.seen.at > UNMOVED_MS) this.since ??= this.seen.at;
    if (this.since !== null && !this.told && now - this.since > PATIENCE_MS) {
      this.told = true;
      this.dispatchEvent(new Event("stuck"));
    }
  }

  // It has moved, or is only now meant to.
  move() {
    this.seen = { time: this.video.currentTime, at: performance.now() };
    this.end();
  }

  end() {
    if (this.since === null) return;
    const seconds = (performance.now() - this.since) / 1000;
    this.since = null;
    if (seconds >= SHORTEST_S) {
      this.dispatchEvent(new CustomEvent("stall", { detail: { seconds } }));
    }
    if (this.told) this.dispatchEvent(new Event("moving"));
    this.told = false;
  }
}
