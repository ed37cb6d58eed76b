// A trial: playing its videos, seeing that they were played, answering, and going on.

import { Answers } from "./answers.js";
import { makePlayers } from "./players.js";
import { Submission } from "./submission.js";
import { WatchedVideos } from "./watched_videos.js";

const videos = [...document.querySelectorAll("main video")];
const evidence = new WatchedVideos(videos);
const answers = new Answers(document.getElementById("answers"));
const needed = document.getElementById("needed");
const watched = document.getElementById("watched");
const LISTED = 3; // more of them are counted
let fetchedAhead = false;

function listed(texts) {
  const last = texts.slice(-1);
  return texts.length > 1 ? `${texts.slice(0, -1).join(", ")} and ${last}` : `${last}`;
}

function missing() {
  const parts = evidence.needed ? [evidence.needed] : [];
  const unanswered = answers.unanswered();
  if (unanswered.length > LISTED) parts.push(`${unanswered.length} answers`);
  else if (unanswered.length) parts.push(`answer ${listed(unanswered)}`);
  return parts;
}

function show() {
  if (submission.busy) return;
  const parts = missing();
  const words = parts.length ? `Still needed: ${parts.join(", ")}` : "All done – press Next";
  // Only a change is read aloud.
  if (needed.textContent !== words) needed.textContent = words;
  needed.classList.toggle("complete", parts.length === 0);
  if (!parts.length) needed.classList.remove("asked");
  watched.textContent = evidence.words;
  watched.classList.toggle("complete", evidence.missing <= 0);
  if (evidence.missing <= 0) fetchAhead();
}

// Only the next trial, one video after the other, and only when this one no longer needs the line.
async function fetchAhead() {
  const following = document.querySelector("[data-following]")?.dataset.following;
  if (fetchedAhead || !following) return;
  fetchedAhead = true;
  try {
    for (const address of following.split(" ")) {
      const answer = await fetch(address, { priority: "low" });
      await answer.blob();
    }
  } catch {
    fetchedAhead = false;
  }
}

makePlayers(videos, document.getElementById("volume"));
watched.closest("[hidden]")?.removeAttribute("hidden");

// A video that fails shows the way on by itself.
function showTrouble() {
  document.querySelector(".trouble").open = true;
}
for (const video of videos) {
  if (video.error) showTrouble();
  video.addEventListener("error", showTrouble);
}

const submission = new Submission(answers, evidence, missing);
evidence.addEventListener("change", show);
answers.addEventListener("change", show);
show();
