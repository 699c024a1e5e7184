/** The occlusion volume of a crown against rays cast at every leaf, and against the exact solution of a layer. */
import { expect, test } from "vitest";
import { type Leaves, skyVisibility } from "../../../../web/src/scene/treeModel/skyVisibility";
import { seededRandom } from "../../seeded";

const SEED = 51;
/** Leaves let a quarter of the light go on; as much more area of black ones keeps as much away. */
const BLACK_COVER = 1 / Math.sqrt(0.75);

type Point = readonly [number, number, number];
const dot = (a: Point, b: Point) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Point, b: Point): Point => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const unit = (a: Point): Point => [a[0] / Math.hypot(...a), a[1] / Math.hypot(...a), a[2] / Math.hypot(...a)];

/** A uniformly distributed direction. */
function direction(random: () => number): Point {
  const [up, azimuth] = [2 * random() - 1, 2 * Math.PI * random()];
  const level = Math.sqrt(1 - up * up);
  return [level * Math.cos(azimuth), up, level * Math.sin(azimuth)];
}

/** Triangles of this area that face all ways, at random places. */
function scattered(count: number, area_m2: number, random: () => number, place: () => Point): Leaves {
  const positions = new Float32Array(9 * count);
  const side_m = Math.sqrt(2 * area_m2);
  for (let k = 0; k < count; k++) {
    const facing = direction(random);
    const u = unit(cross(facing, direction(random)));
    const v = cross(facing, u);
    const from = place();
    for (let axis = 0; axis < 3; axis++) {
      positions[9 * k + axis] = from[axis];
      positions[9 * k + 3 + axis] = from[axis] + side_m * u[axis];
      positions[9 * k + 6 + axis] = from[axis] + side_m * v[axis];
    }
  }
  return { positions, index: Uint32Array.from({ length: 3 * count }, (_, i) => i), cover: BLACK_COVER };
}

/** Whether a ray meets any triangle (Möller and Trumbore 1997). */
function blocked({ positions }: Leaves, from: Point, ray: Point): boolean {
  const corner = (i: number): Point => [positions[i], positions[i + 1], positions[i + 2]];
  for (let i = 0; i < positions.length; i += 9) {
    const a = corner(i);
    const [u, v] = [minus(corner(i + 3), a), minus(corner(i + 6), a)];
    const p = cross(ray, v);
    const determinant = dot(u, p);
    if (Math.abs(determinant) < 1e-12) continue;
    const to = minus(from, a);
    const first = dot(to, p) / determinant;
    const q = cross(to, u);
    const second = dot(ray, q) / determinant;
    if (first >= 0 && second >= 0 && first + second <= 1 && dot(v, q) / determinant > 0) return true;
  }
  return false;
}

test(`the sky seen from places in a crown is that of rays cast at all its leaves (seed ${SEED})`, () => {
  const random = seededRandom(SEED);
  const radius_m = 2;
  const inside = (): Point => {
    const [out, way] = [radius_m * Math.cbrt(random()), direction(random)];
    return [out * way[0], 3 + out * way[1], out * way[2]];
  };
  const leaves = scattered(2500, 0.012, random, inside);
  const seenFrom = skyVisibility([leaves]);
  let [squares, seenSum, castSum] = [0, 0, 0];
  const places = 60;
  for (let k = 0; k < places; k++) {
    const place = inside();
    const rays = 300;
    let open = 0;
    for (let ray = 0; ray < rays; ray++) {
      const [x, y, z] = direction(random);
      if (!blocked(leaves, place, [x, Math.abs(y), z])) open++;
    }
    const [seen] = seenFrom(place);
    squares += (seen - open / rays) ** 2;
    seenSum += seen / places;
    castSum += open / rays / places;
  }
  expect(Math.abs(seenSum - castSum)).toBeLessThan(0.03);
  expect(Math.sqrt(squares / places)).toBeLessThan(0.08);
  expect(castSum).toBeGreaterThan(0.2); // neither black nor empty
  expect(castSum).toBeLessThan(0.8);
});

test(`beneath a wide layer of leaves it is the integral of the transmittance over the sky (seed ${SEED})`, () => {
  const random = seededRandom(SEED);
  const wide_m = 200;
  const layer = scattered(60_000, 1, random, () => [wide_m * (random() - 0.5), 2 + random(), wide_m * (random() - 0.5)]);
  const leafAreaIndex = 60_000 / wide_m ** 2;
  const count = 10_000;
  let exact = 0;
  for (let k = 0; k < count; k++) exact += Math.exp((-0.5 * leafAreaIndex * count) / (k + 0.5)) / count;
  const [beneath] = skyVisibility([layer])([0, 1, 0]);
  expect(Math.abs(beneath - exact)).toBeLessThan(0.05);
});

test(`of very many leaves some are collected, for the same result (seed ${SEED})`, () => {
  const crown = (count: number) => {
    const random = seededRandom(SEED);
    return scattered(count, 100 / count, random, () => [5 * random(), 5 * random(), 5 * random()]);
  };
  const places = [2, 2, 2, 0, 1, 2, 4, 4.5, 1];
  const [few, many] = [40_000, 240_001].map((count) => skyVisibility([crown(count)])(places));
  many.forEach((seen, k) => {
    expect(Math.abs(seen - few[k])).toBeLessThan(0.03); // not 0, because the leaves differ
  });
});

test("all of the sky is seen without leaves, and less with more of them", () => {
  expect([...skyVisibility([])([0, 0, 0, 1, 2, 3])]).toEqual([1, 1]);
  const crown = (count: number) => {
    const random = seededRandom(SEED);
    return scattered(count, 0.01, random, () => [random(), random(), random()]);
  };
  const seen = [100, 300, 1000].map((count) => skyVisibility([crown(count)])([0.5, 0.5, 0.5])[0]);
  expect([...seen].sort((a, b) => b - a)).toEqual(seen);
  const [low, high] = skyVisibility([crown(300)])([0.5, 0, 0.5, 0.5, 1, 0.5]);
  expect(high).toBeGreaterThan(low);
});
