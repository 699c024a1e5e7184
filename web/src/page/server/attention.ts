/** Notices when nobody looks at the page, and when it is worth trying to reach the server again. */
import type { PageState } from "../store/store";

/** Changing tabs back and forth does not disturb the connections. */
const HIDDEN_AFTER_MS = 2000;

/**
 * Writes to `state` whether the page has been hidden for a while. Calls `retry` when the network is back or someone looks
 * at the page: lost connections may be tried at once.
 */
export function followAttention(state: Pick<PageState, "away">, retry: () => void): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const hides = () => {
    timer = setTimeout(() => {
      state.away = true;
    }, HIDDEN_AFTER_MS);
  };
  document.addEventListener("visibilitychange", () => {
    clearTimeout(timer);
    if (document.visibilityState === "hidden") hides();
    else {
      state.away = false;
      retry();
    }
  });
  for (const name of ["online", "focus", "pageshow"]) addEventListener(name, retry);
  if (document.visibilityState === "hidden") hides();
}
