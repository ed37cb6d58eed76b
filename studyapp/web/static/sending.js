// Sending a form's data until the server has answered. Nothing is given up for a lost connection.

const FIRST_WAIT_MS = 1000;
const LONGEST_WAIT_MS = 15000;
export const ANSWERED_MS = 30000; // what takes longer, as on a dead connection, is sent again

// Resolves to an answer that is not the server's own failure; `lost` is called before each retry.
export async function post(form, data, lost) {
  for (let wait = FIRST_WAIT_MS; ; wait = Math.min(2 * wait, LONGEST_WAIT_MS)) {
    try {
      // Not `form.action`: a question of that name would hide it.
      const answer = await fetch(form.getAttribute("action"), {
        method: "POST",
        headers: { Accept: "application/json" },
        body: new URLSearchParams(data),
        signal: AbortSignal.timeout?.(ANSWERED_MS),
      });
      if (answer.status < 500) return { ok: answer.ok, status: answer.status, ...(await answer.json()) };
    } catch {
      // What is sent stays on the page.
    }
    lost();
    await new Promise((resolve) => setTimeout(resolve, wait));
  }
}
