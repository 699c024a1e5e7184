import { element, make, makeButton } from "./dom";

const STAYS_MS = 12_000;

/** Shows what happened and what to do about it; disappears after a timeout or when dismissed. */
export function showToast(title: string, hint: string, tone: "bad" | "good" = "bad"): void {
  const said = [...element("toasts").querySelectorAll("strong")].some(
    (strong) => strong.textContent === title,
  );
  if (said) return;
  const toast = make("div", "", `toast ${tone}`);
  const timer = setTimeout(() => toast.remove(), STAYS_MS);
  const dismiss = makeButton("Dismiss", () => {
    clearTimeout(timer);
    toast.remove();
  });
  toast.append(make("strong", title), dismiss, make("p", hint));
  element("toasts").append(toast);
}
