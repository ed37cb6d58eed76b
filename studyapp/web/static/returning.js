// Nobody new is let in; but who has begun in this window finds the way back.

import { recall } from "./storage.js";

const visit = recall("visit");
if (visit) {
  const form = document.getElementById("returning");
  form.querySelector("[name=visit]").value = visit;
  form.hidden = false;
}
