// Moments are written in UTC by the server, and here as the browser's own clock has them.

const FORMS = {
  moment: { dateStyle: "medium", timeStyle: "short" },
  clock: { timeStyle: "medium" },
};

/** Write every moment within `part` in local time; what it was stays as its title. */
export function writeLocalTimes(part) {
  for (const time of part.querySelectorAll("time[data-form]")) {
    const at = new Date(time.dateTime);
    const today = at.toDateString() === new Date().toDateString();
    const form = FORMS[time.dataset.form] ?? (today ? { timeStyle: "short" } : FORMS.moment);
    time.title = time.textContent;
    time.textContent = at.toLocaleString("en-GB", form);
  }
}

writeLocalTimes(document);
