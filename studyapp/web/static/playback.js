// The buttons of one video. There is no way to skip ahead: only what is played counts.

import { say } from "./words.js";

export class Playback {
  constructor(video, controls) {
    this.video = video;
    this.play = controls.querySelector(".play");
    this.words = this.play.children[1].textContent;
    video.controls = false;
    controls.hidden = false;
    this.play.addEventListener("click", () => this.toggle());
    video.addEventListener("click", () => this.toggle());
    controls.querySelector(".replay").addEventListener("click", () => {
      video.currentTime = 0;
      this.start();
    });
    for (const name of ["play", "pause", "ended"]) {
      video.addEventListener(name, () => this.showState());
    }
    video.addEventListener("ratechange", () => {
      if (video.playbackRate !== 1) video.playbackRate = 1;
    });
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) video.pause();
    });
  }

  toggle() {
    if (this.video.paused) this.start();
    else this.video.pause();
  }

  start() {
    this.video.play().catch(() => this.showState());
  }

  showState() {
    const [symbol, words] = this.play.children;
    symbol.textContent = this.video.paused ? "▶" : "❚❚";
    words.textContent = this.video.paused ? this.words : say("Pause");
  }
}
