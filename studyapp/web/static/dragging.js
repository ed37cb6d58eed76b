// Carrying a card to another part of the page with a mouse, a pen or a finger.

const DRAGGED_FROM = 5; // pixels that a press has moved

// A press that moves carries the card with it; one that does not is a click. `over` gives the target
// at a point of the window, `drop` is told of the one that the card was left on.
export function addDragging(card, { over, drop, click }) {
  let start = null;
  let carried = false;
  let target = null;

  function aim(place) {
    target?.classList.remove("target");
    target = place;
    target?.classList.add("target");
  }

  function settle() {
    aim(null);
    start = null;
    card.classList.remove("carried");
    card.style.transform = "";
  }

  card.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    start = { x: event.clientX, y: event.clientY };
    carried = false;
    card.setPointerCapture(event.pointerId);
  });
  card.addEventListener("pointermove", (event) => {
    if (!start) return;
    const [x, y] = [event.clientX - start.x, event.clientY - start.y];
    if (!carried && Math.hypot(x, y) < DRAGGED_FROM) return;
    carried = true;
    card.classList.add("carried");
    card.style.transform = `translate(${x}px, ${y}px)`;
    aim(over(event.clientX, event.clientY));
  });
  card.addEventListener("pointerup", () => {
    const place = carried && start ? target : null;
    settle();
    if (place) drop(place);
  });
  card.addEventListener("pointercancel", settle);
  card.addEventListener("keydown", (event) => event.key === "Escape" && settle());
  card.addEventListener("click", (event) => {
    // The click that ends a drag; one by a key has no detail.
    if (carried && event.detail) carried = false;
    else click();
  });
}
