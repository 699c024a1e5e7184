/** Sends changes of the wind; recorded winds are long, so those that follow each other quickly are merged. */
import type { WindDocument } from "../../core/wind/document";
import type { Request } from "../../core/wire/wire";

const PAUSE_MS = 250;

export class WindSender {
  private timer: ReturnType<typeof setTimeout> | null = null;
  private waiting: WindDocument | null = null;

  constructor(private readonly send: (request: Request) => void) {}

  change(wind: WindDocument): void {
    if (wind.model !== "recorded" || this.timer === null) this.sendNow(wind);
    else this.waiting = wind;
  }

  private sendNow(wind: WindDocument): void {
    this.dispose();
    this.send({ type: "wind", wind: { ...wind } });
    if (wind.model === "recorded") this.timer = setTimeout(() => this.pauseOver(), PAUSE_MS);
  }

  private pauseOver(): void {
    const { waiting } = this;
    this.timer = null;
    this.waiting = null;
    if (waiting) this.sendNow(waiting);
  }

  dispose(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
    this.waiting = null;
  }
}
