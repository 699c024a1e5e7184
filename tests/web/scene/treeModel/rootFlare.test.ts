import { CylinderGeometry } from "three";
import { describe, expect, it } from "vitest";
import { flareFactor, rootFlare } from "../../../../web/src/scene/treeModel/wood/rootFlare";

/** A stem of radius 0.2 m and 4 m height with rings every metre. */
function stem() {
  const tube = new CylinderGeometry(0.16, 0.2, 4, 12, 4, true).translate(0, 2, 0);
  return {
    positions: new Float32Array(tube.getAttribute("position").array),
    normals: new Float32Array(tube.getAttribute("normal").array),
    uvs: new Float32Array(tube.getAttribute("uv").array),
    index: tube.index?.array ?? [],
  };
}

describe("root flare", () => {
  const wood = stem();
  const flare = rootFlare(wood);
  if (!flare) throw new Error("no flare");
  const corner = (v: number) => flare.positions.subarray(3 * v, 3 * v + 3);
  const count = flare.hold.length;

  it("lies outside of the stem, widest at the ground, and meets it at its top", () => {
    let [top_m, least, most] = [0, 9, 0];
    for (let v = 0; v < count; v++) {
      const [x, y, z] = corner(v);
      const out_m = Math.hypot(x, z);
      const stem_m = 0.2 - 0.01 * Math.max(0, y);
      // Chords of the twelve-sided stem lie inside of its circle.
      expect(out_m).toBeGreaterThan(stem_m * Math.cos(Math.PI / 12));
      if (y < 0) [least, most] = [Math.min(least, out_m / stem_m), Math.max(most, out_m / stem_m)];
      if (y > top_m) top_m = y;
    }
    expect(top_m).toBeCloseTo(0.6, 6);
    for (let v = 0; v < count; v++) {
      const [x, y, z] = corner(v);
      if (y < top_m - 1e-6) continue;
      expect(Math.hypot(x, z) / (0.2 - 0.01 * y)).toBeLessThan(1.004); // no edge is seen
      expect(flare.share[v]).toBeCloseTo(0, 6);
      expect(Math.hypot(...flare.stemNormals.subarray(3 * v, 3 * v + 3))).toBeGreaterThan(0.96);
    }
    expect(least).toBeGreaterThan(1.2);
    expect(most).toBeGreaterThan(1.6);
    expect(most).toBeLessThan(2.3);
  });

  it("is one closed band: every edge belongs to two triangles, but for those at its foot and top", () => {
    const edges = new Map<string, number>();
    const place = (v: number) => [...corner(v)].map((number) => (Math.round(1e4 * number) + 0).toString()).join(" ");
    for (let t = 0; t < flare.index.length; t += 3) {
      for (let k = 0; k < 3; k++) {
        const ends = [place(flare.index[t + k]), place(flare.index[t + ((k + 1) % 3)])].sort().join("|");
        edges.set(ends, (edges.get(ends) ?? 0) + 1);
      }
    }
    for (const [ends, triangles] of edges) {
      const heights = ends.split("|").map((end) => Number(end.split(" ")[1]));
      const rim = heights.every((y) => y < 0) || heights.every((y) => y > 5990);
      expect(triangles, ends).toBe(rim ? 1 : 2);
    }
  });

  it("is moved by vertices of the stem, and keeps the course of the bark's picture", () => {
    for (let v = 0; v < count; v++) {
      const held = flare.hold[v];
      expect(held).toBeLessThan(wood.positions.length / 3);
      const y = Math.max(0, flare.positions[3 * v + 1]);
      expect(flare.uvs?.[2 * v + 1]).toBeCloseTo(y / 4, 5);
    }
  });

  it("has soil on it at the ground, evenly less with height and none at the top", () => {
    const at_m = (v: number) => flare.positions[3 * v + 1];
    const vertices = [...flare.hold.keys()].sort((a, b) => at_m(a) - at_m(b));
    for (const v of vertices) expect(flare.soil[v]).toBeCloseTo(1 - at_m(v) / 0.3, 5);
    expect(flare.soil[vertices[0]]).toBeGreaterThan(1);
    expect(flare.soil[vertices.at(-1) ?? 0]).toBeLessThan(0);
  });

  it("fades with height, and is left out where a mesh has no round base", () => {
    for (let angle = 0; angle < 6.3; angle += 0.3) {
      expect(flareFactor(angle, 0)).toBeGreaterThan(flareFactor(angle, 0.5));
      expect(flareFactor(angle, 3)).toBeLessThan(1.004);
    }
    const positions = Float32Array.of(0, 0, 0, 1, 2, 0, 0, 2, 1);
    const one = { positions, normals: positions, uvs: null, index: [0, 1, 2] };
    expect(rootFlare(one)).toBeNull();
  });
});
