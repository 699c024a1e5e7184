/** The only controls of an embedded forest: pause, and a link to the whole page. */
import { element, make } from "./dom";

export class EmbedBar {
  private readonly pause = make("button", "Pause");

  /** `open` gives the address of the whole page. */
  constructor(pause: () => void, open: () => string) {
    const bar = element("embed");
    bar.hidden = false;
    this.pause.type = "button";
    this.pause.addEventListener("click", pause);
    const link = make("a", "Galewood ↗");
    link.target = "_blank";
    link.rel = "noopener";
    link.href = open();
    link.addEventListener("pointerdown", () => {
      link.href = open(); // as the forest is now
    });
    bar.replaceChildren(this.pause, link);
    this.show(false);
  }

  show(paused: boolean): void {
    this.pause.textContent = paused ? "Play" : "Pause";
    this.pause.setAttribute("aria-label", paused ? "Let the trees move" : "Pause the motion");
  }
}
