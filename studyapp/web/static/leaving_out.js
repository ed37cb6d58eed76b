// Going on without a video that does not play.

import { post } from "./sending.js";

export function leaveOut(form, videos, stalls, evidence, submission) {
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (submission.busy) return;
    const data = [...new FormData(form), [event.submitter.name, event.submitter.value]];
    submission.begin();
    for (const video of videos) stalls.get(video).end();
    // What still waits for data would keep the line from what is sent now.
    for (const video of videos) {
      video.removeAttribute("src");
      video.load();
    }
    await evidence.report();
    const { ok, next } = await post(form, data, () => submission.showLost());
    if (ok) location.replace(next);
    else location.reload();
  });
}
