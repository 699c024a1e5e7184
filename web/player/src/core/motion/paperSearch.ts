/**
 * Algorithm 1 of the paper for many trees at once. Finds the same records as
 * precompute/galewood/player/paper_search.py, and the same poses bit for bit in units of the table's mode scale.
 * Nothing is allocated per step.
 */

import { EXPONENTIAL_SQUARINGS, EXPONENTIAL_TERMS, SEARCH_ANY_AIR, SEARCH_SNAP } from "../constants";
import { lastRecords, poses, type Records } from "../table/records";
import type { Table } from "../table/table";
import { TreeInstances } from "./treeInstances";

const SQUARING_DIVISOR = 2 ** EXPONENTIAL_SQUARINGS;
/** Taylor series of exp(−t) for small t. */
const TERMS = new Float64Array(EXPONENTIAL_TERMS);
for (let n = 0, factorial = 1; n < EXPONENTIAL_TERMS; factorial *= ++n)
  TERMS[n] = (n % 2 === 0 ? 1 : -1) / factorial;

/** 1 − exp(−exponent) for exponent ≥ 0, from sums and products only, so that it is bit-identical in all languages. */
export function gaussian(exponent: number): number {
  const t = Math.min(exponent, 50) / SQUARING_DIVISOR;
  let p = TERMS[EXPONENTIAL_TERMS - 1];
  for (let n = EXPONENTIAL_TERMS - 2; n >= 0; n--) p = p * t + TERMS[n];
  for (let squaring = 0; squaring < EXPONENTIAL_SQUARINGS; squaring++) p *= p;
  return 1 - p;
}

/** Which records a search considers: those in moving air, or in still air (exactly zero pressure). */
const MOVING_AIR = 0;
const STILL_AIR = 1;

export interface LookupOptions {
  /** 0..1: how fast the pose approaches that of the found record; 0 accumulates as in the paper. Default: the table's. */
  readonly poseEasing?: number;
  /** Consider records in still air if, and only if, the air is exactly still. */
  readonly stillAir?: boolean;
}

/** Search among the records of one table. */
export class TableSearch {
  private readonly error: Float64Array;
  private readonly barred: Uint8Array;
  private readonly calm: Uint8Array;
  private readonly byX: Uint16Array;
  private readonly halfPrecision: number;

  constructor(private readonly records: Records) {
    const { pressure, metadata } = records;
    const { sigma_pa: sigma, components } = metadata;
    this.error = Float64Array.from(records.mismatches, (count) => count / components);
    this.barred = lastRecords(records.trajectory);
    this.calm = new Uint8Array(this.barred.length);
    for (let j = 0; j < this.calm.length; j++) {
      this.calm[j] = pressure[2 * j] === 0 && pressure[2 * j + 1] === 0 ? STILL_AIR : MOVING_AIR;
    }
    this.byX = Uint16Array.from(this.calm, (_, j) => j).sort(
      (a, b) => pressure[2 * a] - pressure[2 * b] || a - b,
    );
    this.halfPrecision = 1 / (2 * sigma * sigma);
  }

  /** The record for the next step from a record's state (0: first step); −1 if there is none for this kind of air.
   *  When the air starts to move around a tree in still air, the search starts again with a first step. */
  find(state: number, weight: number, air: number, fx: number, fz: number): number {
    const begins = state === 0 || (air === MOVING_AIR && this.calm[state] === STILL_AIR);
    return begins ? this.nearestPressure(air, fx, fz) : this.bestCandidate(state, weight, air, fx, fz);
  }

  /** First step: among records with a successor, the lowest one of nearest pressure, searched outwards from fx. */
  private nearestPressure(air: number, fx: number, fz: number): number {
    const { byX, calm, barred } = this;
    const { pressure } = this.records;
    let right = this.firstFrom(fx);
    let left = right - 1;
    let best = Number.POSITIVE_INFINITY;
    let found = -1;
    while (left >= 0 || right < byX.length) {
      const toLeft = left >= 0 ? fx - pressure[2 * byX[left]] : Number.POSITIVE_INFINITY;
      const toRight = right < byX.length ? pressure[2 * byX[right]] - fx : Number.POSITIVE_INFINITY;
      const j = toLeft < toRight ? byX[left--] : byX[right++];
      const dx = fx - pressure[2 * j];
      const dz = fz - pressure[2 * j + 1];
      if (dx * dx > best) break;
      const distance = dx * dx + dz * dz;
      const better = distance < best || (distance === best && j < found);
      if (better && barred[j] === 0 && (air === SEARCH_ANY_AIR || calm[j] === air)) {
        best = distance;
        found = j;
      }
    }
    return found;
  }

  /** Index in byX of the first record whose pressure along x is at least fx. */
  private firstFrom(fx: number): number {
    let below = 0;
    let above = this.byX.length;
    while (below < above) {
      const middle = (below + above) >> 1;
      if (this.records.pressure[2 * this.byX[middle]] < fx) below = middle + 1;
      else above = middle;
    }
    return below;
  }

  /** Later steps: the candidate of least total error (Eq. 16); ties go to the successor, then to the lowest index. */
  private bestCandidate(state: number, weight: number, air: number, fx: number, fz: number): number {
    const { offsets, candidate, pressure } = this.records;
    let best = Number.POSITIVE_INFINITY;
    let found = -1;
    for (let s = offsets[state]; s < offsets[state + 1]; s++) {
      const internal = (1 - weight) * this.error[s];
      if (internal > best) break; // sorted by internal error: no later candidate can be better
      const j = candidate[s];
      if (air !== SEARCH_ANY_AIR && this.calm[j] !== air) continue;
      const dx = fx - pressure[2 * j];
      const dz = fz - pressure[2 * j + 1];
      const total = internal + weight * gaussian((dx * dx + dz * dz) * this.halfPrecision);
      if (total < best || (total === best && (j === state || (found !== state && j < found)))) {
        best = total;
        found = j;
      }
    }
    return found;
  }
}

/** Trees of one table, each with its own state, orientation and time scale. */
export class PaperForest extends TreeInstances {
  /** [count] last record found, −1 before the first step; the tree is in the state of its successor. */
  readonly record: Int32Array;
  private readonly search: TableSearch;
  private readonly scale: Float32Array;
  private readonly poses: Int32Array;
  private readonly starts: Uint8Array;
  private readonly easing: number;
  private readonly stillAir: boolean;
  private readonly weight: Float64Array;

  /** `records`: those of the table. */
  constructor(
    table: Table,
    private readonly records: Records,
    count: number,
    options: LookupOptions = {},
  ) {
    super(count, table.metadata.modes, table.metadata.dt_s);
    this.scale = table.modeScale;
    this.search = new TableSearch(records);
    this.poses = poses(records);
    this.starts = new Uint8Array(records.metadata.records);
    for (const start of records.trajectory.subarray(0, -1)) this.starts[start] = 1;
    this.stillAir = options.stillAir ?? true;
    this.easing = options.poseEasing ?? records.metadata.pose_easing;
    this.record = new Int32Array(count).fill(-1);
    this.weight = new Float64Array(count);
  }

  /** Copies the state of trees from another forest of this table; `rows`: their index there, −1 for a new tree. */
  adopt(from: PaperForest, rows: Int32Array): void {
    rows.forEach((row, i) => {
      if (row < 0) return;
      this.takeOver(i, from, row);
      this.record[i] = from.record[row];
      this.weight[i] = from.weight[row];
    });
  }

  protected step(i: number, fx: number, fz: number): void {
    const { initial, maximum, growth } = this.records.metadata.weight;
    const state = this.record[i] + 1;
    const air = this.stillAir ? (fx === 0 && fz === 0 ? STILL_AIR : MOVING_AIR) : SEARCH_ANY_AIR;
    let found = this.search.find(state, this.weight[i], air, fx, fz);
    if (found < 0) found = this.search.find(state, this.weight[i], SEARCH_ANY_AIR, fx, fz); // no record for this kind of air: search all
    const follows = state > 0 && found === state;
    this.weight[i] = follows ? Math.min(maximum, this.weight[i] + growth) : initial;
    this.record[i] = found;
    if (this.easing > 0) this.ease(i, found);
    else this.accumulate(i, found);
  }

  private accumulate(i: number, found: number): void {
    const { now, before, r, width } = this;
    const { dq } = this.records;
    for (let k = 0; k < r; k++) {
      before[i * width + k] = now[i * width + k];
      now[i * width + k] += dq[found * r + k];
    }
  }

  /** Follows the record's own trajectory; the offset from it decays like a critically damped spring. */
  private ease(i: number, found: number): void {
    const { now, before, poses: pose, easing, r, width } = this;
    const { dq } = this.records;
    const keep = (1 - easing) * (1 - easing);
    const pull = easing * easing;
    let settled = true;
    for (let k = 0; k < r; k++) {
      const at = i * width + k;
      const came = this.starts[found] === 1 ? 0 : dq[(found - 1) * r + k];
      const offset = now[at] - pose[found * r + k];
      const speed = keep * (now[at] - before[at] - came) - pull * offset;
      before[at] = now[at];
      now[at] = pose[(found + 1) * r + k] + (offset + speed);
      settled = settled && Math.abs(offset + speed) < SEARCH_SNAP && Math.abs(speed) < SEARCH_SNAP;
    }
    if (!settled) return;
    for (let k = 0; k < r; k++) now[i * width + k] = pose[(found + 1) * r + k];
  }

  protected show(i: number, part: number): void {
    const { now, before, q, scale, r, width } = this;
    for (let k = 0; k < r; k++) {
      const at = i * width + k;
      q[i * r + k] = (before[at] + (now[at] - before[at]) * part) * scale[k];
    }
  }
}
