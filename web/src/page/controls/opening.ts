/** The page opens with its trees; the controls, which take as long to lay out and paint, come next. */
import { watch } from "../store/signals";
import type { Store } from "../store/store";

/** The first trees have moved by then. */
const AFTER_TREES_MS = 100;
/** Controls do not wait longer for trees. */
const PATIENCE_MS = 1500;

/** Shows the controls soon after the first trees; `load` begins to load those that the page does without until then. */
export function openControls({ state }: Store, load: () => void): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const openIn = (time_ms: number) => {
    clearTimeout(timer);
    timer = setTimeout(open, time_ms);
  };
  const stop = watch(
    () => [state.treesSeen],
    ([seen]) => {
      if (seen) openIn(AFTER_TREES_MS);
    },
  );
  function open(): void {
    stop();
    showControls();
    load();
  }
  openIn(PATIENCE_MS);
}

/** Shows the controls, which index.html hides. */
export const showControls = () => document.body.classList.remove("opening");
