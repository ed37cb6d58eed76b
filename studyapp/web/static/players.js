// All videos of a trial: one plays at a time, all are equally loud, and they load one by one.

import { Playback } from "./playback.js";
import { recall, remember } from "./storage.js";
import { say } from "./words.js";

const TYPED_INTO = "select, textarea, [type=number], [type=text]";

export function makePlayers(videos, slider) {
  const playbacks = new Map();
  for (const video of videos) {
    const player = video.closest(".player");
    playbacks.set(video, new Playback(video, (player ?? document).querySelector(".controls")));
    video.addEventListener("play", () => {
      for (const other of videos) if (other !== video) other.pause();
    });
    for (const name of ["play", "pause", "ended"]) {
      video.addEventListener(name, () => player?.classList.toggle("playing", !video.paused));
    }
    showLoading(video);
  }
  if (slider) keepVolume(videos, slider);
  addKey(videos, playbacks);
  addEnlarging(document.getElementById("larger"), videos);
  loadInOrder(videos);
}

// All videos become larger together, so that none is larger than another; what plays stays in view.
function addEnlarging(button, videos) {
  if (!button) return;
  const { classList } = document.body;
  const show = () => {
    const larger = classList.contains("larger");
    button.textContent = larger ? say("Smaller videos") : say("Larger videos");
    if (larger) videos.find((video) => !video.paused)?.scrollIntoView({ block: "nearest" });
  };
  const turn = () => {
    remember("larger", classList.toggle("larger"));
    show();
  };
  button.addEventListener("click", turn);
  document.addEventListener("keydown", (event) => {
    if (isPressed(event, "l")) turn();
  });
  for (const video of videos) video.addEventListener("play", show);
  classList.toggle("larger", recall("larger") === "true");
  show();
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

// K plays or pauses: the video that has the focus within its player, else the one that was
// played last, else the first.
function addKey(videos, playbacks) {
  let [last] = videos;
  for (const video of videos) video.addEventListener("play", () => { last = video; });
  document.addEventListener("keydown", (event) => {
    if (!isPressed(event, "k")) return;
    const focused = event.target.closest(".player")?.querySelector("video");
    playbacks.get(focused ?? last).toggle();
  });
}

function isPressed({ key, target, ctrlKey, metaKey, altKey, repeat }, letter) {
  if (ctrlKey || metaKey || altKey || repeat || target.matches(TYPED_INTO)) return false;
  return key.toLowerCase() === letter;
}

// Whether there is enough to begin with. Trouble is told elsewhere.
function showLoading(video) {
  const state = document.getElementById(`${video.id}-loading`);
  const show = () => {
    const ready = video.error || video.readyState >= HTMLMediaElement.HAVE_FUTURE_DATA;
    state.textContent = ready || video.preload !== "auto" ? "" : say("loading…");
  };
  for (const name of ["loadstart", "canplay", "canplaythrough", "error", "waiting", "playing"]) {
    video.addEventListener(name, show);
  }
  show();
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
