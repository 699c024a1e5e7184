/** A fixed element of index.html by id; throws if it is missing. */
export function element<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`index.html has no #${id}`);
  return found as T;
}

/** Creates an element with text content (never HTML, because names come from visitors). */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  text = "",
  className = "",
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

/** Creates a button. */
export function makeButton(words: string, pressed: () => void, className = ""): HTMLButtonElement {
  const made = make("button", words, className);
  made.type = "button";
  made.addEventListener("click", pressed);
  return made;
}

/** Replaces a text only if it differs: screen readers announce every replacement. */
export function write(place: HTMLElement, words: string): void {
  if (place.textContent !== words) place.textContent = words;
}

/** The width at which layout.css moves the panels to the bottom of the page, as on a phone. */
export const PHONE_PAGE = "(max-width: 760px)";

/** Pointer movement up to which a press counts as a click. */
const CLICK_PX = 6;

/** Whether a pointer is released where it was pressed. */
export const isClick = (pressed: { x: number; y: number }, released: PointerEvent): boolean =>
  Math.hypot(released.clientX - pressed.x, released.clientY - pressed.y) <= CLICK_PX;

/** Whether the visitor's system asks for little motion. */
export const prefersCalm = (): boolean => matchMedia("(prefers-reduced-motion: reduce)").matches;
