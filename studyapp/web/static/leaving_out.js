// Going on without a video that does not play.

import { post } from "./sending.js";

export function leaveOut(form, videos, stalls, evidence, submission) {
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (submission.busy) return;
    const { name, value } = event.submitter;
    const data = [...new FormData(form), [name, value]];
    const failing = videos.find((video) => video.dataset.watchedUrl.endsWith(value));
    if (failing?.error) data.push(["error", failing.error.code]);
    const sources = videos.map((video) => video.getAttribute("src"));
    submission.begin();
    for (const video of videos) stalls.get(video).end();
    // What still waits for data would keep the line from what is sent now.
    for (const video of videos) {
      video.removeAttribute("src");
      video.load();
    }
    await evidence.report();
    const { ok, status, next, problem } = await post(form, data, () => submission.showLost());
    if (ok) location.replace(next);
    else if (status === 422) {
      for (const [place, video] of videos.entries()) video.src = sources[place];
      submission.stay(problem);
    } else location.reload();
  });
}
