// The same window always starts the same study session, also after going back.

import { recall, remember } from "./storage.js";

const visit = document.querySelector("#start [name=visit]");
const stored = recall("visit");
if (stored) visit.value = stored;
else remember("visit", visit.value);
