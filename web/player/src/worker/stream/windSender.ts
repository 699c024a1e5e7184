/**
 * Sends changes of the wind; recorded winds are long, so those that follow each other quickly are merged. A change that
 * the server has not answered when the connection is lost is sent again over the next one.
 */
import type { WindDocument } from "../../core/wind/document";
import type { Request } from "../../core/wire/wire";

const PAUSE_MS = 250;

export class WindSender {
  private timer: ReturnType<typeof setTimeout> | null = null;
  private waiting: WindDocument | null = null;
  private unanswered: WindDocument | null = null;

  constructor(private readonly send: (request: Request) => void) {}

  change(wind: WindDocument): void {
    this.unanswered = wind;
    if (wind.model !== "recorded" || this.timer === null) this.sendNow(wind);
    else this.waiting = wind;
  }

  /** The server has said which wind blows. */
  answered(): void {
    if (this.waiting === null) this.unanswered = null;
  }

  /** The forest has been requested over a new connection. */
  reconnected(): void {
    if (this.unanswered) this.sendNow(this.unanswered);
  }

  private sendNow(wind: WindDocument): void {
    this.stop();
    this.send({ type: "wind", wind: { ...wind } });
    if (wind.model === "recorded") this.timer = setTimeout(() => this.pauseOver(), PAUSE_MS);
  }

  private pauseOver(): void {
    const { waiting } = this;
    this.timer = null;
    this.waiting = null;
    if (waiting) this.sendNow(waiting);
  }

  private stop(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
    this.waiting = null;
  }

  dispose(): void {
    this.stop();
    this.unanswered = null;
  }
}
