// The buttons under the video. There is no way to skip ahead: only what is played counts.

import { recall, remember } from "./storage.js";

export class Playback {
  constructor(video, controls) {
    this.video = video;
    this.play = controls.querySelector("#play");
    video.controls = false;
    controls.hidden = false;
    this.play.addEventListener("click", () => this.toggle());
    video.addEventListener("click", () => this.toggle());
    controls.querySelector("#replay").addEventListener("click", () => {
      video.currentTime = 0;
      this.start();
    });
    this.keepVolume(controls.querySelector("#volume"));
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
    words.textContent = this.video.paused ? "Play both" : "Pause";
  }

  keepVolume(slider) {
    const stored = Number(recall("volume") ?? 1);
    slider.value = this.video.volume = stored;
    slider.addEventListener("input", () => {
      this.video.volume = Number(slider.value);
      remember("volume", slider.value);
    });
  }
}
