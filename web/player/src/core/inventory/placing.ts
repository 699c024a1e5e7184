/** Places of an inventory in metres about its middle. Twin: precompute/galewood/inventory/reading.py. */
import { InventoryError } from "./errors";
import { local_m } from "./projection";
import type { Skipped } from "./report";

export const MOST_STEMS = 20_000;
/** Stems farther than this from the middle are left out. */
const FARTHEST_M = 1000;

/** A readable row: place in the file's coordinates, height and diameter (m; NaN: unknown). */
export interface Raw {
  readonly line: number;
  readonly x: number;
  readonly y: number;
  readonly species: string;
  readonly height_m: number;
  readonly dbh_m: number;
}

export function median(values: readonly number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  const half = Math.floor(sorted.length / 2);
  return sorted.length % 2 === 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

const extent = (values: readonly number[]): [number, number] =>
  values.reduce<[number, number]>(
    ([low, high], value) => [Math.min(low, value), Math.max(high, value)],
    [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY],
  );

export const spanOf = (values: readonly number[]): number => {
  const [low, high] = extent(values);
  return high - low;
};

const middleOf = (values: readonly number[]): number => {
  const [low, high] = extent(values);
  return 0.5 * (low + high);
};

/** Trees in metres about the middle of the plot, and those that are too far away or too many. */
export function placed(raws: readonly Raw[], geographic: boolean): { kept: Raw[]; far: Skipped[] } {
  // counted from the first stem, as the date line may lie between them
  const turns = raws
    .map(({ x }) => x - raws[0].x + 540)
    .map((turn) => turn - 360 * Math.floor(turn / 360) - 180);
  const origin: [number, number] = [raws[0].x + median(turns), median(raws.map(({ y }) => y))];
  const local = raws.map(({ x, y }): [number, number] => (geographic ? local_m(x, y, origin) : [x, y]));
  const middle = [median(local.map(([x]) => x)), median(local.map(([, y]) => y))];
  const offsets = local.map(([x, y]) => [x - middle[0], y - middle[1]]);
  const distances = offsets.map(([x, y]) => Math.sqrt(x * x + y * y));
  const order = raws.map((_, k) => k).sort((a, b) => distances[a] - distances[b]);
  const near = new Set(order.slice(0, MOST_STEMS).filter((k) => distances[k] <= FARTHEST_M));
  const far = raws.flatMap(({ line }, k) => (near.has(k) ? [] : [{ line, reason: reasonOf(distances[k]) }]));
  const kept = raws.map((_, k) => k).filter((k) => near.has(k));
  if (kept.length === 0) {
    throw new InventoryError(`all stems are more than ${FARTHEST_M} m from their centre`);
  }
  const x0 = middleOf(kept.map((k) => offsets[k][0]));
  const y0 = middleOf(kept.map((k) => offsets[k][1]));
  return { kept: kept.map((k) => ({ ...raws[k], x: offsets[k][0] - x0, y: offsets[k][1] - y0 })), far };
}

const reasonOf = (distance_m: number): string =>
  distance_m > FARTHEST_M
    ? `${distance_m.toFixed(0)} m from the centre; at most ${FARTHEST_M} m are shown`
    : `beyond the ${MOST_STEMS} stems nearest to the centre`;
