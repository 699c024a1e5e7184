/** Bar, percentage and remaining time of one computation; counts down between the server's reports. */

import type { Job } from "../server/api";
import { make } from "../ui/dom";
import { progressLine } from "../ui/words";
import { ProgressBar } from "./progressBar";
import { RemainingTime } from "./remainingTime";

const TICK_MS = 1000;
const now_s = () => performance.now() / 1000;

export class JobProgress {
  readonly bar: ProgressBar;
  readonly line = make("p");
  readonly percent = make("span");
  private readonly remaining = new RemainingTime();
  private job: Pick<Job, "state" | "stage" | "fraction" | "seconds_left"> | null = null;
  private readonly timer = setInterval(() => this.say(), TICK_MS);

  constructor(name: string) {
    this.bar = new ProgressBar(`Computing ${name}`);
  }

  show(job: Pick<Job, "state" | "stage" | "fraction" | "seconds_left">): void {
    this.job = job;
    this.remaining.report(job.state === "running" ? job.seconds_left : null, now_s());
    const percent = this.bar.show(job.fraction);
    this.percent.textContent = job.state === "queued" ? "queued" : `${percent} %`;
    this.say();
  }

  private say(): void {
    if (!this.job) return;
    const words = progressLine({ ...this.job, seconds_left: this.remaining.left(now_s()) });
    if (this.line.textContent !== words) this.line.textContent = words;
  }

  /** Ends the countdown with other words. */
  end(words: string): void {
    clearInterval(this.timer);
    this.job = null;
    this.percent.textContent = "";
    this.line.textContent = words;
  }
}
