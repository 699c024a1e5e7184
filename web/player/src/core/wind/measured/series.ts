/**
 * Samples at equal intervals: in order, without duplicates, gaps bridged.
 * Twin: precompute/galewood/wind/measured/series.py, which explains the limits.
 */
import { MeasurementError } from "./errors";
import type { Samples } from "./samples";

const FASTEST_RATE_HZ = 10;
const FEWEST = 10;
const GAP = 1.5;
const BRIDGED_S = 60;
const BRIDGED_INTERVALS = 3;
const ON_TIME = 0.02;

/** What was found in the samples before they were put in order. */
export interface Found {
  readonly rows: number;
  readonly missing: number;
  readonly duplicates: number;
  readonly disordered: number;
  readonly gaps: number;
  readonly longestGap_s: number;
  readonly interval_s: number;
  readonly duration_s: number;
  /** Start of the longest piece, from the first sample. */
  readonly pieceStart_s: number;
}

/** Velocities (m/s, east and north) at equal intervals. */
export interface Series {
  readonly interval_s: number;
  readonly east_m_s: readonly number[];
  readonly north_m_s: readonly number[];
}

type Timed = readonly [time_s: number, east_m_s: number, north_m_s: number];

const steps = (rows: readonly Timed[]): number[] => rows.slice(1).map(([time_s], k) => time_s - rows[k][0]);

/** Puts the samples in order and at equal intervals; throws MeasurementError if too few are left. */
export function seriesOf(samples: Samples): { series: Series; found: Found } {
  const rows: Timed[] = spread(samples.time_s).map((t, k) => [t, samples.east_m_s[k], samples.north_m_s[k]]);
  const timed = rows.filter(([t]) => !Number.isNaN(t));
  const disordered = steps(timed).filter((step) => step < 0).length;
  timed.sort((a, b) => a[0] - b[0]);
  const unique = timed.filter(([t], k) => k === 0 || t > timed[k - 1][0]);
  const valid = unique.filter(([, u, v]) => !Number.isNaN(u) && !Number.isNaN(v));
  if (valid.length < FEWEST) {
    throw new MeasurementError(
      `only ${valid.length} samples have a time and a wind; at least ${FEWEST} are needed`,
    );
  }
  const interval_s = intervalOf(unique);
  const gaps = steps(valid).filter((pause) => pause > GAP * interval_s);
  const piece = longestPiece(valid, interval_s);
  if (piece.length < FEWEST) {
    const longest_s = Math.max(BRIDGED_S, BRIDGED_INTERVALS * interval_s);
    throw new MeasurementError(
      `the longest piece without a gap of more than ${longest_s.toFixed(0)} s has only ${piece.length} samples; at least ${FEWEST} are needed`,
    );
  }
  const found: Found = {
    rows: rows.length,
    missing: rows.length - (timed.length - unique.length) - valid.length,
    duplicates: timed.length - unique.length,
    disordered,
    gaps: gaps.length,
    longestGap_s: gaps.reduce((most, gap) => Math.max(most, gap), 0),
    interval_s,
    duration_s: valid[valid.length - 1][0] - valid[0][0] + interval_s,
    pieceStart_s: piece[0][0] - valid[0][0],
  };
  return { series: evenly(piece, interval_s), found };
}

/** The times; if most are repeated, as by loggers that write whole seconds, spread over their interval. */
function spread(times: readonly number[]): number[] {
  const same = times.filter((time_s, k) => k > 0 && time_s === times[k - 1]).length;
  const even = [...times];
  if (2 * same < times.length) return even;
  const starts = times.flatMap((time_s, k) => (k === 0 || time_s !== times[k - 1] ? [k] : []));
  if (starts.length < 3) return even;
  const ends = [...starts.slice(1), times.length];
  const counts = starts.map((start, k) => ends[k] - start).sort((a, b) => a - b);
  const most = counts[Math.floor(starts.length / 2)];
  starts.forEach((start, k) => {
    const near = k + 1 < starts.length ? k : k - 1;
    const count = ends[k] - start;
    const step = (times[starts[near + 1]] - times[starts[near]]) / Math.max(count, most);
    // the first second may begin in its middle
    const missing = k === 0 ? Math.max(most - count, 0) : 0;
    for (let i = start; i < ends[k]; i++) even[i] = times[start] + (i - start + missing) * step;
  });
  return even;
}

/** The interval of the series: the mean of those that are near the median. */
function intervalOf(rows: readonly Timed[]): number {
  const all = steps(rows);
  const median = [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)];
  const near = all.filter((step) => step >= median / GAP && step <= GAP * median);
  return near.reduce((sum, step) => sum + step, 0) / near.length;
}

function longestPiece(rows: readonly Timed[], interval_s: number): readonly Timed[] {
  const longest_s = Math.max(BRIDGED_S, BRIDGED_INTERVALS * interval_s);
  const cuts = steps(rows).flatMap((step, k) => (step > longest_s ? [k + 1] : []));
  let best = [0, 0];
  [0, ...cuts].forEach((start, k) => {
    const end = cuts[k] ?? rows.length;
    if (end - start > best[1] - best[0]) best = [start, end];
  });
  return rows.slice(best[0], best[1]);
}

function evenly(piece: readonly Timed[], measured_s: number): Series {
  const fast = measured_s < (1 - ON_TIME) / FASTEST_RATE_HZ;
  const interval_s = fast ? 1 / FASTEST_RATE_HZ : measured_s;
  const rows = fast ? averaged(piece, interval_s) : piece;
  const start_s = rows[0][0];
  const count = Math.floor((rows[rows.length - 1][0] - start_s) / interval_s + 0.5) + 1;
  const east = new Array<number>(count);
  const north = new Array<number>(count);
  let k = 0;
  for (let i = 0; i < count; i++) {
    const time_s = start_s + i * interval_s;
    while (k + 2 < rows.length && rows[k + 1][0] <= time_s) k++;
    const [a, b] = [rows[k], rows[k + 1]];
    let share = Math.min(Math.max((time_s - a[0]) / (b[0] - a[0]), 0), 1);
    if (Math.abs(a[0] - time_s) <= ON_TIME * interval_s) share = 0;
    if (Math.abs(b[0] - time_s) <= ON_TIME * interval_s) share = 1;
    east[i] = a[1] + share * (b[1] - a[1]);
    north[i] = a[2] + share * (b[2] - a[2]);
  }
  return { interval_s, east_m_s: east, north_m_s: north };
}

/** Means over intervals, at their middle; intervals without samples are left out. */
function averaged(rows: readonly Timed[], interval_s: number): Timed[] {
  const start_s = rows[0][0];
  const means: Timed[] = [];
  let [bin, count, east, north] = [0, 0, 0, 0];
  const finish = () => means.push([start_s + (bin + 0.5) * interval_s, east / count, north / count]);
  for (const [time_s, u, v] of rows) {
    const k = Math.floor((time_s - start_s) / interval_s + 1e-6);
    if (k !== bin) {
      finish();
      [bin, count, east, north] = [k, 0, 0, 0];
    }
    count++;
    east += u;
    north += v;
  }
  finish();
  return means;
}
