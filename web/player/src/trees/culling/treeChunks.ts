/** Neighbouring trees of one species, which are culled together. Pure. */
import { INSTANCE_FLOATS, type InstanceData } from "../instanceData";

/** Side of the square that the trees of a chunk stand in, m. */
const CHUNK_M = 48;
/** Fewer trees are one chunk. */
const FEWEST_TREES = 512;

export interface Chunk {
  readonly trees: Uint32Array;
  /** Middle of their places, and the largest distance of one from it, m. */
  readonly x: number;
  readonly z: number;
  readonly radius_m: number;
  /** Heights of their feet, m. */
  readonly lowest_m: number;
  readonly highest_m: number;
  /** Their largest scale. */
  readonly scale: number;
}

/** The trees by squares; inside a chunk in their own order. */
export function chunksOf({ count, data }: InstanceData): Chunk[] {
  const squares = new Map<number, number[]>();
  for (let tree = 0; tree < count; tree++) {
    const [x, , z] = data.subarray(tree * INSTANCE_FLOATS, tree * INSTANCE_FLOATS + 3);
    // columns of the squares are in 0 … 2¹⁶ − 1 within 1500 km
    const square =
      count < FEWEST_TREES ? 0 : 65_536 * Math.floor(x / CHUNK_M) + Math.floor(z / CHUNK_M) + 32_768;
    const own = squares.get(square);
    if (own) own.push(tree);
    else squares.set(square, [tree]);
  }
  return Array.from(squares.values(), (trees) => chunkOf(trees, data));
}

function chunkOf(trees: readonly number[], data: Float32Array): Chunk {
  const of = (channel: number) => trees.map((tree) => data[tree * INSTANCE_FLOATS + channel]);
  const [xs, ys, zs, scales] = [0, 1, 2, 6].map(of);
  const middle = (values: readonly number[]) => 0.5 * (least(values) + most(values));
  const [x, z] = [middle(xs), middle(zs)];
  const radius_m = most(xs.map((own, k) => Math.hypot(own - x, zs[k] - z)));
  return {
    trees: Uint32Array.from(trees),
    x,
    z,
    radius_m,
    lowest_m: least(ys),
    highest_m: most(ys),
    scale: most(scales),
  };
}

const least = (values: readonly number[]): number =>
  values.reduce((a, b) => Math.min(a, b), Number.POSITIVE_INFINITY);
const most = (values: readonly number[]): number =>
  values.reduce((a, b) => Math.max(a, b), Number.NEGATIVE_INFINITY);
