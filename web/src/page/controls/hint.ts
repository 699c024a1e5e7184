/** The first hint, shown once to every visitor until the first action. */
import { element, PHONE_PAGE } from "../ui/dom";

const STORAGE_KEY = "galewood.hint";
const WIDE_HINT = "Drag the arrow. Click a tree. Pull a branch.";
/** On a phone the arrow is behind a button. */
const PHONE_HINT = "Tap a tree. Pull a branch. “Wind” has an arrow to drag.";

type Shelf = Pick<Storage, "getItem" | "setItem">;

function seen(shelf: () => Shelf): boolean {
  try {
    return shelf().getItem(STORAGE_KEY) !== null;
  } catch {
    return false; // storage is blocked
  }
}

/** Shows the hint unless this visitor has seen it. */
export function showHint(shelf: () => Shelf): void {
  if (seen(shelf)) return;
  const hint = element("hint");
  hint.textContent = matchMedia(PHONE_PAGE).matches ? PHONE_HINT : WIDE_HINT;
  hint.hidden = false;
  const acted = new AbortController();
  const dismiss = () => {
    acted.abort();
    hint.hidden = true;
    try {
      shelf().setItem(STORAGE_KEY, "1");
    } catch {
      // shown again next time
    }
  };
  for (const action of ["pointerup", "keydown"])
    addEventListener(action, dismiss, { signal: acted.signal, capture: true });
}
