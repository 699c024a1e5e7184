/** Anemometer samples (wind speed and tip displacement) at equal time steps. Pure. */

export const RATE_HZ = 30;
export const KEPT_SAMPLES = 2048;

export class Recorder {
  readonly time_s = new Float64Array(KEPT_SAMPLES);
  readonly speed_m_s = new Float64Array(KEPT_SAMPLES);
  readonly tip_m = new Float64Array(KEPT_SAMPLES);
  count = 0;
  private next_s = Number.NaN;

  clear(): void {
    this.count = 0;
    this.next_s = Number.NaN;
  }

  /** Calls `measure` for every sample due up to a time; restarts after a jump in time. */
  advance(now_s: number, measure: (time_s: number) => { speed_m_s: number; tip_m: number }): void {
    if (Number.isNaN(this.next_s) || now_s < this.next_s - 1 || now_s > this.next_s + 2) {
      this.clear();
      this.next_s = now_s;
    }
    for (; this.next_s <= now_s; this.next_s += 1 / RATE_HZ) {
      const { speed_m_s, tip_m } = measure(this.next_s);
      this.push(this.next_s, speed_m_s, tip_m);
    }
  }

  /** Appends a sample; the oldest is dropped when the buffer is full. */
  push(time_s: number, speed_m_s: number, tip_m: number): void {
    if (this.count === KEPT_SAMPLES) {
      for (const column of [this.time_s, this.speed_m_s, this.tip_m]) column.copyWithin(0, 1);
      this.count--;
    }
    this.time_s[this.count] = time_s;
    this.speed_m_s[this.count] = speed_m_s;
    this.tip_m[this.count] = tip_m;
    this.count++;
    this.next_s = Math.max(Number.isNaN(this.next_s) ? time_s : this.next_s, time_s);
  }
}
