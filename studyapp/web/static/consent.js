// The same window always starts the same study session, also after going back.

const visit = document.querySelector("#start [name=visit]");
const stored = sessionStorage.getItem("visit");
if (stored) visit.value = stored;
else sessionStorage.setItem("visit", visit.value);
