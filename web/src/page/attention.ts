/** Notices when nobody looks at the page, and when it is worth trying to reach the server again. */

export interface AttentionEvents {
  /** The page has been hidden for a while, or is visible again. */
  hide(hidden: boolean): void;
  /** The network is back or someone looks at the page: lost connections may be tried at once. */
  retry(): void;
}

/** Changing tabs back and forth does not disturb the connections. */
const HIDDEN_AFTER_MS = 2000;

export class Attention {
  private readonly life = new AbortController();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private told = false;

  constructor(private readonly events: AttentionEvents) {
    const { signal } = this.life;
    document.addEventListener("visibilitychange", () => this.look(), { signal });
    for (const name of ["online", "focus", "pageshow"])
      addEventListener(name, () => events.retry(), { signal });
    if (this.hidden) this.look();
  }

  get hidden(): boolean {
    return document.visibilityState === "hidden";
  }

  private look(): void {
    clearTimeout(this.timer);
    if (this.hidden) this.timer = setTimeout(() => this.tell(true), HIDDEN_AFTER_MS);
    else {
      this.tell(false);
      this.events.retry();
    }
  }

  private tell(hidden: boolean): void {
    if (hidden === this.told) return;
    this.told = hidden;
    this.events.hide(hidden);
  }

  dispose(): void {
    clearTimeout(this.timer);
    this.life.abort();
  }
}
