/** A steady estimate of the time that a computation still takes, from the server's, which jump. Pure. */

/** Estimates that are taken into account. */
const MAX_KEPT_ESTIMATES = 3;
/** Overtime after which the estimate is given up, s, and relative to the whole time. */
const LATE_S = 10;
const LATE_SHARE = 0.1;

function median(values: readonly number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

export class RemainingTime {
  /** Expected times of the end, newest last. */
  private ends_s: number[] = [];
  private reported_s: number | null = null;
  private began_s: number | null = null;

  /** Takes an estimate of the server; null: it has none. The same number again is the same report. */
  report(left_s: number | null, now_s: number): void {
    this.began_s ??= now_s;
    if (left_s === null) this.ends_s = [];
    else if (left_s !== this.reported_s)
      this.ends_s = [...this.ends_s, now_s + left_s].slice(-MAX_KEPT_ESTIMATES);
    this.reported_s = left_s;
  }

  /** Seconds left: counts down between reports. Null without an estimate, "late" long after the expected end. */
  left(now_s: number): number | "late" | null {
    if (this.ends_s.length === 0 || this.began_s === null) return null;
    const end_s = median(this.ends_s);
    const late_s = Math.max(LATE_S, LATE_SHARE * (end_s - this.began_s));
    return now_s > end_s + late_s ? "late" : Math.max(0, end_s - now_s);
  }
}
