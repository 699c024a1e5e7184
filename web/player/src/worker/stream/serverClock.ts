/** Estimates the server's clock from the recent ping with the shortest round trip. Pure. */

const MAX_KEPT_PINGS = 16;

export class ServerClock {
  private readonly seen: { round_ms: number; ahead_ms: number }[] = [];
  private ahead_ms: number | null = null;

  /** Adds a ping: send time, receive time, and the server's time in between. */
  pong(sent_ms: number, back_ms: number, server_s: number): void {
    const round_ms = back_ms - sent_ms;
    this.seen.push({ round_ms, ahead_ms: server_s * 1000 - (sent_ms + back_ms) / 2 });
    if (this.seen.length > MAX_KEPT_PINGS) this.seen.shift();
    this.ahead_ms = this.seen.reduce((best, one) => (one.round_ms < best.round_ms ? one : best)).ahead_ms;
  }

  /** Age (ms) of a server clock time; null before the first answer. */
  age_ms(server_s: number, now_ms: number): number | null {
    return this.ahead_ms === null ? null : now_ms + this.ahead_ms - server_s * 1000;
  }
}
