/** Waiting times between attempts to reconnect. Pure. */

const FIRST_MS = 250;
const LONGEST_MS = 30_000;

/**
 * The bound doubles with every failed attempt; the time is drawn from its upper half, so that the clients of a server
 * that returns do not all come at once.
 */
export class Backoff {
  private bound_ms = FIRST_MS;

  /** `random` gives numbers in 0..1. */
  constructor(private readonly random: () => number = Math.random) {}

  /** Time until the next attempt, ms. */
  next_ms(): number {
    const { bound_ms } = this;
    this.bound_ms = Math.min(LONGEST_MS, 2 * bound_ms);
    return 0.5 * bound_ms * (1 + this.random());
  }

  /** Called after a success, or when there is a reason to try at once. */
  reset(): void {
    this.bound_ms = FIRST_MS;
  }
}
