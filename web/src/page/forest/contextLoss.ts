/** Loss of the graphics context, as after a crash or reset of the GPU: nothing is drawn until the browser restores it. */
import { showToast } from "../ui/toast";

/** If it has not come back by then, the visitor is told what to do. */
const PATIENCE_MS = 1500;

function explain(): void {
  showToast(
    "The browser has reset its graphics.",
    "The forest continues as soon as it can draw again. If it stays still, reload the page.",
  );
}

export class ContextLoss {
  /** Whether the context is lost. */
  lost = false;

  /** `restored` is called when everything must be drawn again. */
  constructor(canvas: HTMLCanvasElement, restored: () => void) {
    let timer: ReturnType<typeof setTimeout> | undefined;
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault(); // or the browser does not restore it
      this.lost = true;
      timer = setTimeout(explain, PATIENCE_MS);
    });
    canvas.addEventListener("webglcontextrestored", () => {
      clearTimeout(timer);
      this.lost = false;
      restored();
    });
  }
}
