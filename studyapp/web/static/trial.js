// A trial: playing its videos, seeing that they were played, answering, and going on.

import { Answers } from "./answers.js";
import { FetchingAhead } from "./fetching_ahead.js";
import { leaveOut } from "./leaving_out.js";
import { makePlayers } from "./players.js";
import { Stalls } from "./stalls.js";
import { Submission } from "./submission.js";
import { Trouble } from "./trouble.js";
import { WatchedVideos } from "./watched_videos.js";
import { listed, say, sayCount } from "./words.js";

const videos = [...document.querySelectorAll("main video")];
const stalls = new Map(videos.map((video) => [video, new Stalls(video)]));
const evidence = new WatchedVideos(videos, stalls);
const answers = new Answers(document.getElementById("answers"));
const needed = document.getElementById("needed");
const watched = document.getElementById("watched");
const LISTED = 3; // more of them are counted

function missing() {
  const parts = evidence.needed ? [evidence.needed] : [];
  const unanswered = answers.unanswered();
  if (unanswered.length > LISTED) {
    parts.push(sayCount("{count} answer", "{count} answers", unanswered.length));
  } else if (unanswered.length) parts.push(say("answer {questions}", { questions: listed(unanswered) }));
  return parts;
}

function stillNeeded(parts) {
  const { why } = evidence;
  if (why) return say("{why}. Still needed: {parts}", { why, parts });
  return say("Still needed: {parts}", { parts });
}

function show() {
  if (submission.busy) return;
  const parts = missing();
  const words = parts.length ? stillNeeded(parts.join(say(", "))) : say("All done – press Next");
  // Only a change is read aloud.
  if (needed.textContent !== words) needed.textContent = words;
  needed.classList.toggle("complete", parts.length === 0);
  if (!parts.length) needed.classList.remove("asked");
  watched.textContent = evidence.words;
  watched.classList.toggle("complete", evidence.missing <= 0);
  if (evidence.missing <= 0) fetching.begin();
}

const ahead = document.querySelector("[data-following]")?.dataset.following.split(" ") ?? [];
const fetching = new FetchingAhead(ahead, document.getElementById("saved"));

makePlayers(videos, document.getElementById("volume"));
for (const video of videos) new Trouble(video, stalls.get(video));
watched.closest("[hidden]")?.removeAttribute("hidden");

const submission = new Submission(answers, evidence, missing);
leaveOut(document.getElementById("unplayable"), videos, stalls, evidence, submission);
evidence.addEventListener("change", show);
answers.addEventListener("change", show);
show();
