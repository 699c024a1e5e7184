/** The collars of boughs, on a bough that leaves a round stem at an angle. */
import { describe, expect, it } from "vitest";
import { branchCollars, collarFade } from "../../../../web/src/scene/treeModel/wood/collars";
import {
  between,
  cross,
  dot,
  minus,
  type Point,
  plus,
  unit,
} from "../../../../web/src/scene/treeModel/points";
import { nearestOn, tubesOf } from "../../../../web/src/scene/treeModel/wood/tubes";

const STEM_M = 0.2;
const BOUGH_M = 0.08;
const AROUND = 24;
/** Rings of the bough are so far apart, m. */
const RING_M = 0.6;

/** Tubes as the generator writes them: rings whose last vertex repeats the first one, from each start along each direction. */
function woodOf(tubes: readonly { from: Point; along: Point; radius_m: number; rings: number }[]) {
  const [positions, normals, uvs, index, ofVertex]: number[][] = [[], [], [], [], []];
  tubes.forEach(({ from, along, radius_m, rings }, piece) => {
    const side = unit(cross([0.3, 0.1, 1], along));
    const first = ofVertex.length;
    for (let ring = 0; ring < rings; ring++) {
      for (let k = 0; k <= AROUND; k++) {
        const out = between(side, cross(side, along), (2 * Math.PI * (k % AROUND)) / AROUND);
        positions.push(...plus(plus(from, along, ring * RING_M), out, radius_m));
        normals.push(...out);
        uvs.push(k / AROUND, ring);
        ofVertex.push(piece);
        const a = first + ring * (AROUND + 1) + k;
        if (ring > 0 && k < AROUND) index.push(a - AROUND - 1, a, a - AROUND, a - AROUND, a, a + 1);
      }
    }
  });
  const [p, n, u] = [positions, normals, uvs].map((values) => Float32Array.from(values));
  return { wood: { positions: p, normals: n, uvs: u, index }, ofVertex };
}

const along: Point = unit([1, 0.8, 0]);
const from: Point = [0, 2, 0];
const stem = { from: [0, 0, 0] as Point, along: [0, 1, 0] as Point, radius_m: STEM_M, rings: 9 };
const { wood, ofVertex } = woodOf([stem, { from, along, radius_m: BOUGH_M, rings: 6 }]);
const copies = structuredClone(wood);
const collar = branchCollars(wood, tubesOf(wood, ofVertex));
if (!collar) throw new Error("no collar");
const count = collar.hold.length;
const at = (values: Float32Array, v: number): Point => [values[3 * v], values[3 * v + 1], values[3 * v + 2]];
const place = (v: number) => at(collar.positions, v);
const vertices = [...Array(count).keys()];
/** Distance from the axis of the bough, m. */
const aside_m = (p: Point) => Math.hypot(...plus(minus(p, from), along, -dot(minus(p, from), along)));
const outOfStem_m = ([x, , z]: Point) => Math.hypot(x, z) - STEM_M;

describe("branch collars", () => {
  it("find the tubes of the wood with their radii, and the parent on whose axis a bough begins", () => {
    const tubes = tubesOf(wood, ofVertex);
    expect(tubes.map(({ middles }) => middles.length)).toEqual([9, 6]);
    expect(tubes[1].radii_m[0]).toBeCloseTo(BOUGH_M, 6);
    expect(nearestOn(tubes[0], tubes[1].middles[0]).away_m).toBeLessThan(1e-6);
    expect(nearestOn(tubes[0], [0.5, 1.3, 0]).point[1]).toBeCloseTo(1.3, 6);
  });

  it("widen the bough at the surface of the stem, more below than above and least to the sides", () => {
    const junction = vertices.filter((v) => Math.abs(outOfStem_m(place(v))) < 0.012);
    expect(junction.length).toBeGreaterThan(AROUND);
    // Distances along and across the stem from where the axis of the bough leaves it.
    const middle_m = 2 + 0.8 * STEM_M;
    const up = junction.map((v) => place(v)[1] - middle_m);
    const half_m = BOUGH_M / along[0]; // the bough's section along the stem is an ellipse
    expect(Math.max(...up)).toBeGreaterThan(half_m + 0.4 * BOUGH_M);
    expect(-Math.min(...up)).toBeGreaterThan(half_m + 0.7 * BOUGH_M);
    const wide = junction.map((v) => Math.abs(place(v)[2]));
    expect(Math.max(...wide)).toBeGreaterThan(1.2 * BOUGH_M);
    expect(Math.max(...wide)).toBeLessThan(1.4 * BOUGH_M);
    expect(collarFade(0)).toBe(1);
    expect(collarFade(1)).toBe(0);
  });

  it("begin inside the stem, lie on or outside of the bough, and end on it", () => {
    const inside = vertices.filter((v) => outOfStem_m(place(v)) < -0.02);
    expect(inside.length).toBe(2 * AROUND + 1);
    let farthest_m = 0;
    for (const v of vertices) {
      // Half-way corners lie on the chords of the bough.
      expect(aside_m(place(v))).toBeGreaterThan(BOUGH_M * Math.cos(Math.PI / AROUND) - 1e-6);
      farthest_m = Math.max(farthest_m, outOfStem_m(place(v)));
    }
    expect(farthest_m).toBeLessThan(4.5 * BOUGH_M);
    const rows = count / (2 * AROUND + 1);
    for (const v of vertices.filter((one) => one % rows === rows - 1)) {
      expect(aside_m(place(v))).toBeLessThan(1.006 * BOUGH_M); // no edge is seen
      const radial = unit(minus(place(v), plus(from, along, dot(minus(place(v), from), along))));
      expect(dot(at(collar.normals, v), radial)).toBeGreaterThan(0.9999);
    }
  });

  it("have normals of unit length that agree with their triangles, and with the stem's where they run into it", () => {
    for (const v of vertices) expect(Math.hypot(...at(collar.normals, v))).toBeCloseTo(1, 5);
    for (let t = 0; t < collar.index.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => collar.index[t + k]);
      const face = cross(minus(place(b), place(a)), minus(place(c), place(a)));
      const seen = unit([0, 1, 2].map((k) => [a, b, c].reduce((sum, v) => sum + collar.normals[3 * v + k], 0)) as unknown as Point);
      const outside = [a, b, c].every((v) => outOfStem_m(place(v)) > -0.005);
      if (outside) expect(dot(unit(face), seen)).toBeGreaterThan(0.5);
    }
    for (const v of vertices.filter((one) => outOfStem_m(place(one)) < -0.02)) {
      const [x, , z] = place(v);
      expect(dot(at(collar.normals, v), unit([x, 0, z]))).toBeGreaterThan(0.99);
    }
  });

  it("keep the bough's picture of the bark, are moved by its vertices, and leave the wood as it is", () => {
    for (const v of vertices) {
      expect(ofVertex[collar.hold[v]]).toBe(1);
      const rows = count / (2 * AROUND + 1);
      if (v % rows === 0) continue; // the innermost ring has the texture of the next one
      const rise = dot(minus(place(v), from), along) / RING_M;
      const widened = (aside_m(place(v)) - BOUGH_M) / RING_M;
      expect(Math.abs(collar.uvs[2 * v + 1] - rise)).toBeLessThan(0.01 + 2 * Math.max(0, widened));
    }
    expect(wood).toEqual(copies);
  });

  it("are left out for wood that is not made of rings, and for boughs that begin elsewhere", () => {
    expect(branchCollars({ ...wood, uvs: null }, tubesOf({ ...wood, uvs: null }, ofVertex))).toBeNull();
    const apart = woodOf([stem, { from: [0.19, 2, 0], along, radius_m: BOUGH_M, rings: 6 }]);
    expect(branchCollars(apart.wood, tubesOf(apart.wood, apart.ofVertex))).toBeNull();
    const lone = woodOf([stem]);
    expect(branchCollars(lone.wood, tubesOf(lone.wood, lone.ofVertex))).toBeNull();
  });
});
