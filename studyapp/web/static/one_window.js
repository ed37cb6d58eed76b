// Of two windows that show the same study session, the newer one goes on and the older one says so.
// The channel's name is made from the participant's address by the server, and leads nowhere.

const dialog = document.getElementById("elsewhere");
let gaveWay = false;
let leaving = false;

function giveWay() {
  gaveWay = true;
  for (const media of document.querySelectorAll("video, audio")) media.pause();
  if (!dialog.open) dialog.showModal();
}

// A page that comes back as it was left may be an old one.
addEventListener("pageshow", (event) => {
  if (event.persisted) location.replace(dialog.dataset.address);
});

// Where Firefox forbids cookies this fails, and the server alone keeps two windows apart.
if ("BroadcastChannel" in window && dialog.showModal) {
  const channel = new BroadcastChannel(`study session ${dialog.dataset.window}`);
  channel.addEventListener("message", giveWay);

  // A window that was opened behind others has not taken over yet.
  const arrive = () => {
    if (document.visibilityState === "visible") channel.postMessage("here");
    else document.addEventListener("visibilitychange", arrive, { once: true });
  };
  arrive();
}

dialog.querySelector("button").addEventListener("click", () => {
  leaving = true;
  location.replace(dialog.dataset.address);
});
dialog.addEventListener("close", () => {
  if (!leaving) dialog.showModal();
});
// Neither Escape nor a key that is meant for the answers does anything behind it.
addEventListener("keydown", (event) => {
  if (!gaveWay) return;
  event.stopPropagation();
  if (event.key === "Escape") event.preventDefault();
}, { capture: true });
