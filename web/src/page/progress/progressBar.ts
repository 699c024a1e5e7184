/** A bar that shows how much of something is done. */
import { make } from "../ui/dom";

export class ProgressBar {
  readonly root = make("div", "", "bar");
  private readonly fill = make("i");

  constructor(label: string) {
    this.root.setAttribute("role", "progressbar");
    this.root.setAttribute("aria-label", label);
    this.root.setAttribute("aria-valuemin", "0");
    this.root.setAttribute("aria-valuemax", "100");
    this.root.append(this.fill);
    this.show(0);
  }

  /** Shows a share, 0 to 1; returns it in percent. */
  show(share: number): number {
    const percent = Math.round(100 * Math.min(1, Math.max(0, share)));
    this.root.setAttribute("aria-valuenow", String(percent));
    this.fill.style.transform = `scaleX(${percent / 100})`;
    return percent;
  }
}
