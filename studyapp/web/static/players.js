// All videos of a trial: one plays at a time, all are equally loud, and they load one by one.

import { Playback } from "./playback.js";
import { recall, remember } from "./storage.js";

export function makePlayers(videos, slider) {
  for (const video of videos) {
    const player = video.closest(".player");
    new Playback(video, (player ?? document).querySelector(".controls"));
    video.addEventListener("play", () => {
      for (const other of videos) if (other !== video) other.pause();
    });
    for (const name of ["play", "pause", "ended"]) {
      video.addEventListener(name, () => player?.classList.toggle("playing", !video.paused));
    }
  }
  if (slider) keepVolume(videos, slider);
  loadInOrder(videos);
}

function keepVolume(videos, slider) {
  slider.value = Number(recall("volume") ?? 1);
  const setAll = () => {
    for (const video of videos) video.volume = Number(slider.value);
  };
  setAll();
  slider.addEventListener("input", () => {
    setAll();
    remember("volume", slider.value);
  });
}

// The next one is only asked for when the one before it can play through.
function loadInOrder([video, ...others]) {
  if (!others.length) return;
  const goOn = () => {
    others[0].preload = "auto";
    loadInOrder(others);
  };
  if (video.readyState >= HTMLMediaElement.HAVE_ENOUGH_DATA || video.error) goOn();
  else {
    const settled = new AbortController();
    for (const name of ["canplaythrough", "error"]) {
      video.addEventListener(name, () => { settled.abort(); goOn(); }, { signal: settled.signal });
    }
  }
}
