// A trial: playing the pair, seeing that it was played, answering, and going on.

import { Answers } from "./answers.js";
import { Playback } from "./playback.js";
import { Submission } from "./submission.js";
import { WatchEvidence } from "./watch_evidence.js";

const video = document.getElementById("pair");
const evidence = new WatchEvidence(video);
const answers = new Answers(document.getElementById("answers"));
const needed = document.getElementById("needed");
const watched = document.getElementById("watched");
let fetchedAhead = false;

function listed(numbers) {
  const last = numbers.slice(-1);
  return numbers.length > 1 ? `${numbers.slice(0, -1).join(", ")} and ${last}` : `${last}`;
}

function missing() {
  const parts = evidence.missing > 0 ? ["play the pair to the end"] : [];
  const numbers = answers.unanswered();
  if (numbers.length) parts.push(`answer ${listed(numbers)}`);
  return parts;
}

function watchedText() {
  if (evidence.missing <= 0) return "Watched ✓";
  if (evidence.silent) return "Turn the sound on, please";
  return `Watched: still ${Math.ceil(evidence.missing)} s`;
}

function show() {
  if (submission.busy) return;
  const parts = missing();
  const words = parts.length ? `Still needed: ${parts.join(", ")}` : "All done – press Next";
  // Only a change is read aloud.
  if (needed.textContent !== words) needed.textContent = words;
  needed.classList.toggle("complete", parts.length === 0);
  if (!parts.length) needed.classList.remove("asked");
  watched.textContent = watchedText();
  watched.classList.toggle("complete", evidence.missing <= 0);
  if (evidence.missing <= 0) fetchAhead();
}

// Only the next pair, and only when this one no longer needs the line.
function fetchAhead() {
  if (fetchedAhead || !video.dataset.following) return;
  fetchedAhead = true;
  fetch(video.dataset.following, { priority: "low" }).catch(() => {
    fetchedAhead = false;
  });
}

new Playback(video, document.getElementById("controls"));
// A video that fails shows the way on by itself.
function showTrouble() {
  document.querySelector(".trouble").open = true;
}
if (video.error) showTrouble();
video.addEventListener("error", showTrouble);

const submission = new Submission(answers, evidence, missing);
evidence.addEventListener("change", show);
answers.addEventListener("change", show);
show();
