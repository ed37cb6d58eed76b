// A video that stalls or fails says so by itself, and offers two ways on: to load it again, which
// keeps its place and what was watched, or to go on without it.

import { say } from "./words.js";

const BACK_S = 0.5; // by so much it goes back, so that no part is left out

export class Trouble {
  constructor(video, stalls) {
    this.video = video;
    this.address = video.getAttribute("src");
    this.reloads = 0;
    this.panel = document.getElementById(`${video.id}-fault`);
    this.words = this.panel.querySelector("[role=alert]");
    video.addEventListener("error", () => this.fail());
    stalls.addEventListener("stuck", () => this.show(say("This video has stopped loading.")));
    stalls.addEventListener("moving", () => this.hide());
    video.addEventListener("playing", () => this.hide());
    for (const button of document.querySelectorAll(`[data-reloads="${video.id}"]`)) {
      button.addEventListener("click", () => this.reload());
    }
    if (video.error) this.fail();
  }

  // The store that sends the videos may be down: then the server sends its own copy.
  fail() {
    const { ownCopy } = this.video.dataset;
    if (ownCopy && this.video.getAttribute("src") !== ownCopy) return this.load(ownCopy);
    this.show(say("This video cannot be played."));
  }

  show(words) {
    this.panel.hidden = false;
    // Only words that come into a part in view are read aloud.
    this.words.textContent = words;
  }

  hide() {
    this.panel.hidden = true;
    this.words.textContent = "";
  }

  // Under another address, since a browser may keep what it got under this one.
  reload() {
    this.reloads += 1;
    this.video.preload = "auto";
    this.load(`${this.address}?again=${this.reloads}`);
    this.hide();
    (this.video.closest(".player, .stage") ?? document).querySelector(".play").focus();
  }

  load(address) {
    const { video } = this;
    const place = Math.max(0, (video.ended ? 0 : video.currentTime) - BACK_S);
    video.pause();
    video.src = address;
    video.load();
    // Not before there is a picture: jumping earlier leaves it blank in some browsers.
    video.addEventListener("loadeddata", () => { video.currentTime = place; }, { once: true });
  }
}
