/** Words about a pull: a label beside the hand, and announcements for screen readers. */
import { make } from "../ui/dom";

/** Displacement and force in words. Pure. */
export function pullInWords(moved_m: number, force_N: number): string {
  const length = moved_m < 1 ? `${Math.round(100 * moved_m)} cm` : `${moved_m.toFixed(2)} m`;
  const force = force_N < 1000 ? `${Math.round(force_N)} N` : `${(force_N / 1000).toFixed(1)} kN`;
  return `${length} · ${force}`;
}

export class PullTag {
  private readonly tag = make("div", "", "pull-tag");
  private readonly status = make("div", "", "pull-status");

  constructor(private readonly over: HTMLElement) {
    this.tag.hidden = true;
    this.tag.setAttribute("aria-hidden", "true");
    this.status.setAttribute("role", "status");
    const parent = over.parentElement ?? document.body;
    parent.append(this.tag, this.status);
  }

  /** Shows the label at a place of the canvas, px. */
  show(left_px: number, top_px: number, words: string): void {
    const { clientWidth, clientHeight } = this.over;
    this.tag.hidden = false;
    if (this.tag.textContent !== words) this.tag.textContent = words;
    const x = Math.min(Math.max(left_px + 16, 4), Math.max(4, clientWidth - 130));
    const y = Math.min(Math.max(top_px - 34, 4), Math.max(4, clientHeight - 34));
    this.tag.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
  }

  hide(): void {
    this.tag.hidden = true;
  }

  announce(words: string): void {
    this.status.textContent = words;
  }
}
