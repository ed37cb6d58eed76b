// A page whose content is still being computed asks for itself until it is there.

const SECONDS = 3;
const awaited = document.getElementById("awaited");

setTimeout(() => location.replace(awaited.dataset.address), SECONDS * 1000);
