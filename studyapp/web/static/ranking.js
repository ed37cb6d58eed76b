// Cards that are put in order by clicks, by dragging, or by keys. The menus beside them hold the
// answer; they can be used instead, and work alone where there is no script.

import { addDragging } from "./dragging.js";
import { freeRanks, gap, placed, ranksOf, twice } from "./order.js";
import { recall, remember } from "./storage.js";
import { listed, say } from "./words.js";

function made(tag, name) {
  const element = document.createElement(tag);
  element.className = name;
  return element;
}

class Ranking {
  constructor(part, told) {
    this.part = part;
    this.told = told;
    this.menus = [...part.querySelectorAll("select")];
    this.shared = "ties" in part.dataset;
    this.words = [...this.menus[0].options].map((option) => option.dataset.place);
    this.places = made("ol", "places");
    for (const words of this.words.slice(1)) {
      const place = made("li", "place");
      place.append(made("span", ""));
      place.firstChild.textContent = words;
      this.places.append(place);
    }
    this.tray = made("div", "tray");
    this.order = made("p", "order");
    this.below = made("div", "waiting");
    this.below.append(this.tray, this.order);
    this.cards = this.menus.map((menu, card) => this.makeCard(menu.dataset.label, card));
    part.after(this.places, this.below);
    part.addEventListener("change", () => this.show());
    this.show();
  }

  get ranks() {
    return ranksOf(this.part);
  }

  makeCard(label, card) {
    const button = made("button", "card");
    button.type = "button";
    button.textContent = label;
    button.addEventListener("keydown", (event) => this.key(event, card));
    addDragging(button, {
      over: (x, y) => this.under(x, y),
      drop: (place) => this.move(card, [...this.places.children].indexOf(place) + 1),
      click: () => this.move(card, this.ranks[card] ? 0 : freeRanks(this.ranks)[0]),
    });
    return button;
  }

  // The place, or the tray, at a point of the window.
  under(x, y) {
    const spot = document.elementFromPoint(x, y)?.closest(".place, .waiting");
    return spot === this.below || spot?.parentElement === this.places ? spot : null;
  }

  key(event, card) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const rank = this.ranks[card];
    const last = this.cards.length;
    const wanted = {
      ArrowLeft: rank ? Math.max(rank - 1, 1) : freeRanks(this.ranks)[0],
      ArrowRight: rank ? Math.min(rank + 1, last) : freeRanks(this.ranks)[0],
      Home: 1,
      End: last,
      Delete: 0,
      Backspace: 0,
    };
    wanted.ArrowUp = wanted.ArrowLeft;
    wanted.ArrowDown = wanted.ArrowRight;
    const number = Number(event.key);
    const target = number >= 1 && number <= last ? number : wanted[event.key];
    if (target === undefined) return;
    event.preventDefault();
    this.move(card, target);
  }

  move(card, rank) {
    const focused = this.cards[card] === document.activeElement;
    placed(this.ranks, card, rank, this.shared).forEach((each, index) => {
      this.menus[index].value = each || "";
    });
    this.menus[card].dispatchEvent(new Event("change", { bubbles: true }));
    if (focused) this.cards[card].focus();
    this.told.textContent = this.said(card);
  }

  said(card) {
    const rank = this.ranks[card];
    const label = this.menus[card].dataset.label;
    if (!rank) return say("{label}: no place yet", { label });
    return say("{place} of {count}: {label}", { place: this.words[rank], count: this.cards.length, label });
  }

  show() {
    this.ranks.forEach((rank, card) => {
      const home = rank ? this.places.children[rank - 1] : this.tray;
      if (this.cards[card].parentElement !== home) home.append(this.cards[card]);
      this.cards[card].setAttribute("aria-label", this.said(card));
    });
    const problem = this.problem();
    this.order.textContent = problem || this.summary();
    this.order.classList.toggle("wrong", problem !== "");
  }

  summary() {
    const ranks = this.ranks;
    const parts = this.words.map((place, rank) => {
      const labels = this.menus.filter((_, card) => ranks[card] === rank);
      const cards = labels.map((menu) => menu.dataset.label).join(" = ");
      return rank && cards ? say("{place} {cards}", { place, cards }) : "";
    });
    const order = listed(parts.filter((part) => part));
    return order && say("Your order: {order}", { order });
  }

  problem() {
    const ranks = this.ranks;
    if (!this.shared && twice(ranks)) return say("Two videos have the same rank: each needs its own.");
    if (ranks.includes(0) || gap(ranks) === undefined) return "";
    return say("No video is {place}: please leave no rank out.", { place: this.words[gap(ranks)] });
  }
}

// All rankings of a page, as cards or as menus: what was chosen holds for the pages to come.
function addRankings(help, parts) {
  const told = made("p", "unseen");
  told.setAttribute("role", "status");
  help.after(told);
  const rankings = [...parts].map((part) => new Ranking(part, told));
  const choice = help.querySelector("button");
  let menus = recall("menus") === "true";
  const show = () => {
    choice.textContent = menus ? say("Use letters instead") : say("Use menus instead");
    help.querySelector("p").hidden = menus;
    for (const { part, places, tray } of rankings) {
      part.hidden = !menus;
      places.hidden = tray.hidden = menus;
    }
  };
  choice.addEventListener("click", () => {
    menus = !menus;
    remember("menus", menus);
    show();
  });
  show();
  help.hidden = false;
}

addRankings(document.querySelector(".ordering"), document.querySelectorAll(".ranks"));
