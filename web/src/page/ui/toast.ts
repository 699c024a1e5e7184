import { element, make, makeButton } from "./dom";

const STAYS_MS = 12_000;

/**
 * Shows what happened and what to do about it; disappears after a timeout or when dismissed. One that offers to try again
 * stays.
 */
export function showToast(
  title: string,
  hint: string,
  tone: "bad" | "good" = "bad",
  tryAgain: (() => void) | null = null,
): void {
  const said = [...element("toasts").children].some(
    (shown) =>
      shown.querySelector("strong")?.textContent === title &&
      (!tryAgain || shown.querySelector("p")?.textContent === hint),
  );
  if (said) return;
  const toast = make("div", "", `toast ${tone}`);
  const timer = tryAgain ? 0 : setTimeout(() => toast.remove(), STAYS_MS);
  const end = (then?: () => void) => {
    clearTimeout(timer);
    toast.remove();
    then?.();
  };
  const dismiss = makeButton("Dismiss", () => end());
  const buttons = make("div");
  if (tryAgain) buttons.append(makeButton("Try again", () => end(tryAgain)));
  buttons.append(dismiss);
  toast.append(make("strong", title), buttons, make("p", hint));
  element("toasts").append(toast);
}
