/**
 * The root flare of a built-in tree, whose stem begins as a plain cylinder: near the ground it widens into the roots, more in
 * some directions than in others, and reaches below the ground, also on a slope. Drawn over the lowest part of the stem, from
 * whose triangles it is cut. Pure.
 */
import { hashUnit } from "galewood/random";

/** The wood of a tree: positions, normals, texture coordinates (or none) and triangles; y points up. */
export interface Wood {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly uvs: Float32Array | null;
  readonly index: ArrayLike<number>;
}

export interface FlareMesh {
  readonly positions: Float32Array;
  /** Of the stem, at the places of the vertices. */
  readonly stemNormals: Float32Array;
  /** Of each vertex: 1 at the ground, 0 at the top, where the flare is the stem again. */
  readonly share: Float32Array;
  /** Of each vertex: soil on the bark, 1 at the ground and below 0 where none reaches; linear in the height. */
  readonly soil: Float32Array;
  readonly uvs: Float32Array | null;
  readonly index: Uint32Array;
  /** Of each vertex: the vertex of the stem that moves it. */
  readonly hold: Uint32Array;
}

/** Vertices this close to the lowest one (m) belong to the base of the stem. */
const BASE_M = 0.04;
/** A base has at least so many vertices. */
const LEAST_AROUND = 5;
/** Height of the flare, its mean width at the ground and the height over which it fades, all relative to the stem's radius. */
const FLARE_HEIGHT = 3;
const FLARE_WIDTH = 0.62;
const FADE_HEIGHT = 0.75;
/** The surface is cut at these shares of the height. */
const CUT_SHARES = [0.08, 0.2, 0.36, 0.58] as const;
/** How far the flare reaches below the ground, m. */
const SUNK_M = 0.3;
/** Soil and wet litter reach so high up the bark, relative to the stem's radius. */
const SOIL_HEIGHT = 1.5;
/** Thickness that it keeps outside of the stem at the top, relative to the radius: too little to be seen. */
const CLEAR_SHARE = 0.002;
/** The stem is within so many radii of its axis. */
const NEAR_SHARE = 1.8;
/** Directions with a root, and how different they are. */
const ROOT_COUNT = 5;
const HASH_SEED = 613;

/** A corner while triangles are cut: a mixture of vertices of the stem. */
interface Corner {
  readonly place: readonly [number, number, number];
  readonly normal: readonly [number, number, number];
  readonly uv: readonly [number, number];
  readonly hold: number;
}
type Triangle = readonly [Corner, Corner, Corner];

function mixed(a: Corner, b: Corner, share: number): Corner {
  const between = (from: Corner["place"], to: Corner["place"]) =>
    [0, 1, 2].map((k) => from[k] + share * (to[k] - from[k])) as unknown as Corner["place"];
  return {
    place: between(a.place, b.place),
    normal: between(a.normal, b.normal),
    uv: [a.uv[0] + share * (b.uv[0] - a.uv[0]), a.uv[1] + share * (b.uv[1] - a.uv[1])],
    hold: share < 0.5 ? a.hold : b.hold,
  };
}

/** The parts of a convex polygon below and above a height, as fans of triangles. */
function cut(triangle: Triangle, height_m: number): { below: Triangle[]; above: Triangle[] } {
  const sides: [Corner[], Corner[]] = [[], []];
  triangle.forEach((corner, k) => {
    const next = triangle[(k + 1) % 3];
    const [from, to] = [corner.place[1] - height_m, next.place[1] - height_m];
    sides[from < 0 ? 0 : 1].push(corner);
    if (from < 0 !== to < 0) {
      const on = mixed(corner, next, from / (from - to));
      sides[0].push(on);
      sides[1].push(on);
    }
  });
  const [below, above] = sides.map((polygon) =>
    polygon.slice(2).map((corner, k): Triangle => [polygon[0], polygon[k + 1], corner]),
  );
  return { below, above };
}

/** Factor of the stem's radius: `rise`: height above the base over the radius of the stem. */
export function flareFactor(angle_rad: number, rise: number): number {
  let roots = 0;
  for (let root = 0; root < ROOT_COUNT; root++) {
    const heading = (2 * Math.PI * (root + 0.7 * hashUnit(HASH_SEED, root, 0))) / ROOT_COUNT;
    const toward = Math.max(0, Math.cos(angle_rad - heading));
    roots += (0.5 + hashUnit(HASH_SEED, root, 1)) * toward ** 8;
  }
  const fade = Math.exp(-Math.max(0, rise) / FADE_HEIGHT) * shareAt(rise);
  return 1 + CLEAR_SHARE + FLARE_WIDTH * fade * (0.5 + 0.9 * roots);
}

/** 1 at the ground, 0 at the top of the flare, and level there. */
function shareAt(rise: number): number {
  const left = Math.min(1, Math.max(0, 1 - rise / FLARE_HEIGHT));
  return left * left * (3 - 2 * left);
}

/** Radius of the stem at its base and the height of the next vertices above it; null if it has no round base. */
function baseOf({ positions }: Wood): { low_m: number; radius_m: number } | null {
  let low_m = Number.POSITIVE_INFINITY;
  for (let v = 1; v < positions.length; v += 3) low_m = Math.min(low_m, positions[v]);
  let [sum, count] = [0, 0];
  for (let v = 0; v < positions.length; v += 3) {
    if (positions[v + 1] > low_m + BASE_M) continue;
    sum += Math.hypot(positions[v], positions[v + 2]);
    count++;
  }
  return count >= LEAST_AROUND && sum > 0 ? { low_m, radius_m: sum / count } : null;
}

/** The flare of a stem that stands at the origin; null if the mesh has no round base there. */
export function rootFlare(wood: Wood): FlareMesh | null {
  const base = baseOf(wood);
  if (!base) return null;
  const { low_m, radius_m } = base;
  const top_m = low_m + FLARE_HEIGHT * radius_m;
  let triangles = lowest(wood, top_m, NEAR_SHARE * radius_m);
  for (const share of CUT_SHARES) {
    triangles = triangles.flatMap((triangle) => {
      const { below, above } = cut(triangle, low_m + share * FLARE_HEIGHT * radius_m);
      return [...below, ...above];
    });
  }
  triangles = triangles.flatMap((triangle) => cut(triangle, top_m).below);
  return joined(triangles, wood, low_m, radius_m);
}

/** The triangles around the axis that reach below a height. */
function lowest({ positions, normals, uvs, index }: Wood, top_m: number, within_m: number): Triangle[] {
  const corner = (v: number): Corner => ({
    place: [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]],
    normal: [normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]],
    uv: uvs ? [uvs[2 * v], uvs[2 * v + 1]] : [0, 0],
    hold: v,
  });
  const found: Triangle[] = [];
  for (let t = 0; t < index.length; t += 3) {
    const triangle: Triangle = [corner(index[t]), corner(index[t + 1]), corner(index[t + 2])];
    const low = triangle.some(({ place }) => place[1] < top_m);
    if (low && triangle.every(({ place: [x, , z] }) => Math.hypot(x, z) < within_m)) found.push(triangle);
  }
  return found;
}

/** Widened, with equal corners joined. */
function joined(triangles: readonly Triangle[], { uvs }: Wood, low_m: number, radius_m: number): FlareMesh {
  const known = new Map<string, number>();
  const positions: number[] = [];
  const stemNormals: number[] = [];
  const shares: number[] = [];
  const soils: number[] = [];
  const textures: number[] = [];
  const hold: number[] = [];
  const index = triangles.flat().map(({ place: [x, y, z], normal, uv, hold: held }) => {
    const key = [x, y, z, ...uv].map((number) => Math.round(1e4 * number)).join(" ");
    const before = known.get(key);
    if (before !== undefined) return before;
    const factor = flareFactor(Math.atan2(z, x), (y - low_m) / radius_m);
    const drawn_m = y < low_m + BASE_M ? y - SUNK_M : y;
    positions.push(factor * x, drawn_m, factor * z);
    soils.push(1 - (drawn_m - low_m) / (SOIL_HEIGHT * radius_m));
    stemNormals.push(...normal);
    shares.push(shareAt((y - low_m) / radius_m));
    textures.push(...uv);
    hold.push(held);
    known.set(key, hold.length - 1);
    return hold.length - 1;
  });
  return {
    positions: Float32Array.from(positions),
    stemNormals: Float32Array.from(stemNormals),
    share: Float32Array.from(shares),
    soil: Float32Array.from(soils),
    uvs: uvs && Float32Array.from(textures),
    index: Uint32Array.from(index),
    hold: Uint32Array.from(hold),
  };
}
