/* Files go up piece by piece, and on where they stopped: after a lost line, a reload or a crash. */

import { refresh } from "./refreshing.js";

const AT_ONCE = 3;
const LONGEST_PAUSE = 30;

const form = document.getElementById("upload");
const chosen = document.getElementById("files");
const condition = document.getElementById("condition");
const list = document.getElementById("uploads");
const code = form.querySelector("[name=form_code]").value;
const piece = Number(form.dataset.piece);

const waiting = [];
let running = 0;
let refused = 0;

class Row {
  constructor(name) {
    this.item = document.createElement("li");
    this.bar = document.createElement("progress");
    this.words = document.createElement("span");
    this.bar.setAttribute("aria-label", name);
    this.item.append(name, " ", this.bar, " ", this.words);
    list.append(this.item);
  }

  show(here, size) {
    this.bar.max = size || 1;
    this.bar.value = here;
    this.describe(`${Math.floor((100 * here) / (size || 1))}%`);
  }

  describe(words) {
    this.words.textContent = words;
  }

  refuse(words) {
    refused += 1;
    this.item.className = "problem";
    this.item.textContent = words;
  }
}

function pause(seconds) {
  return new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
}

async function ask(address, options) {
  const answer = await fetch(address, { redirect: "manual", ...options });
  if (answer.type === "opaqueredirect") {
    return { problem: "You are logged out. Log in again, and choose the file once more." };
  }
  if (answer.status >= 500 || answer.status === 429) {
    throw new Error(`${answer.status}`);
  }
  const isTold = answer.headers.get("Content-Type").startsWith("application/json");
  return isTold ? answer.json() : { problem: "The server refused this. Open the page again." };
}

async function upload(file, of, row) {
  const what = { condition: of, name: file.name, size: file.size, changed: file.lastModified };
  const address = (offset) => `${form.dataset.uploads}?${new URLSearchParams({ ...what, offset })}`;
  // The server tells where to go on, also if that is not at the beginning.
  let [here, seconds] = [0, 1];
  do {
    let body;
    try {
      body = await file.slice(here, here + piece).arrayBuffer();
    } catch {
      row.refuse(`The file ${file.name} has been changed or moved. Choose it again.`);
      return;
    }
    try {
      const options = { method: "POST", body, headers: { "Form-Code": code } };
      const told = await ask(address(here), options);
      if (told.problem) {
        row.refuse(told.problem);
        return;
      }
      here = told.offset;
      seconds = 1;
      row.show(here, file.size);
    } catch {
      row.describe("Waiting for the server …");
      await pause(seconds);
      seconds = Math.min(2 * seconds, LONGEST_PAUSE);
    }
  } while (here < file.size);
}

function goOn() {
  while (running < AT_ONCE && waiting.length) {
    const next = waiting.shift();
    running += 1;
    upload(...next).finally(() => {
      running -= 1;
      goOn();
    });
  }
  if (running || waiting.length) {
    return;
  }
  if (refused) {
    refresh(); // what is refused stays to be read
  } else {
    location.reload();
  }
}

function add(files) {
  const of = condition.value.trim();
  for (const file of files) {
    const row = new Row(file.name);
    row.show(0, file.size);
    waiting.push([file, of, row]);
  }
  goOn();
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  add(chosen.files);
  chosen.value = "";
});
form.addEventListener("dragover", (event) => event.preventDefault());
form.addEventListener("drop", (event) => {
  event.preventDefault();
  add(event.dataTransfer.files);
});
window.addEventListener("beforeunload", (event) => {
  if (running) {
    event.preventDefault();
  }
});
