// A trial: playing its videos, seeing that they were played, answering, and going on.

import { Answers } from "./answers.js";
import { makePlayers } from "./players.js";
import { Submission } from "./submission.js";
import { WatchedVideos } from "./watched_videos.js";
import { listed, say, sayCount } from "./words.js";

const videos = [...document.querySelectorAll("main video")];
const evidence = new WatchedVideos(videos);
const answers = new Answers(document.getElementById("answers"));
const needed = document.getElementById("needed");
const watched = document.getElementById("watched");
const LISTED = 3; // more of them are counted
let fetchedAhead = false;

function missing() {
  const parts = evidence.needed ? [evidence.needed] : [];
  const unanswered = answers.unanswered();
  if (unanswered.length > LISTED) {
    parts.push(sayCount("{count} answer", "{count} answers", unanswered.length));
  } else if (unanswered.length) parts.push(say("answer {questions}", { questions: listed(unanswered) }));
  return parts;
}

function show() {
  if (submission.busy) return;
  const parts = missing();
  const words = parts.length
    ? say("Still needed: {parts}", { parts: parts.join(say(", ")) })
    : say("All done – press Next");
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
