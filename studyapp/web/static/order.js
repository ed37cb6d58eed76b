// An order as its ranks: one number for each card, 1 the best and 0 for none yet.

// Those that the menus of a ranking hold.
export function ranksOf(part) {
  return [...part.querySelectorAll("select")].map((menu) => Number(menu.value));
}

// The ranks once `card` is put on `rank`. Where no rank is shared, the cards in its way move on
// towards the nearest free one, rather to where `card` came from.
export function placed(ranks, card, rank, shared) {
  const after = [...ranks];
  after[card] = 0;
  if (rank && !shared) {
    const from = ranks[card] || ranks.length;
    const [free] = freeRanks(after).sort(
      (a, b) => Math.abs(a - rank) - Math.abs(b - rank) || Math.abs(a - from) - Math.abs(b - from),
    );
    const step = Math.sign(rank - free);
    for (let hole = free; hole !== rank; hole += step) after[after.indexOf(hole + step)] = hole;
  }
  after[card] = rank;
  return after;
}

export function freeRanks(ranks) {
  return ranks.map((_, index) => index + 1).filter((rank) => !ranks.includes(rank));
}

// The rank that no card has although a later one is taken, else undefined.
export function gap(ranks) {
  return freeRanks(ranks).find((rank) => rank < Math.max(...ranks));
}

export function twice(ranks) {
  return ranks.some((rank, card) => rank && ranks.indexOf(rank) !== card);
}

export function isOrder(ranks, shared) {
  return !ranks.includes(0) && gap(ranks) === undefined && (shared || !twice(ranks));
}
