/** Precomputed shading of foliage: rounded normals, openness to the sky, flutter weights. Pure. */
import type { Components } from "./components";

interface Point {
  x: number;
  y: number;
  z: number;
}

/** Leaf normals bent away from the crown's centre, so that the crown is shaded as one soft volume. */
export function roundNormals(positions: Float32Array, normals: Float32Array, centre: Point): Float32Array {
  const out = new Float32Array(normals.length);
  for (let i = 0; i < out.length; i += 3) {
    const ox = positions[i] - centre.x;
    const oy = positions[i + 1] - centre.y;
    const oz = positions[i + 2] - centre.z;
    const far = Math.hypot(ox, oy, oz) || 1;
    const facing = normals[i] * ox + normals[i + 1] * oy + normals[i + 2] * oz < 0 ? -1 : 1;
    const x = ox / far + 0.45 * facing * normals[i];
    const y = oy / far + 0.45 * facing * normals[i + 1] + 0.15;
    const z = oz / far + 0.45 * facing * normals[i + 2];
    const length = Math.hypot(x, y, z) || 1;
    out[i] = x / length;
    out[i + 1] = y / length;
    out[i + 2] = z / length;
  }
  return out;
}

/** Openness: 1 at the outside and top of the crown, down to 0.3 near the trunk. */
export function openness(positions: Float32Array, centre: Point, radius_m: number): Float32Array {
  const out = new Float32Array(positions.length / 3);
  for (let v = 0; v < out.length; v++) {
    const out_m = Math.hypot(positions[v * 3] - centre.x, positions[v * 3 + 2] - centre.z);
    const up_m = positions[v * 3 + 1] - centre.y;
    const shell = Math.hypot(out_m, up_m) / radius_m;
    out[v] = Math.min(1, 0.3 + 0.62 * shell ** 1.3 + 0.18 * Math.max(-0.6, up_m / radius_m));
  }
  return out;
}

/** Flutter weight of each leaf vertex by distance from the first vertex: 0 at the twig, 1 at the tip. */
export function leafReach(pieces: Components, positions: Float32Array): Float32Array {
  const first = new Int32Array(pieces.count).fill(-1);
  const reach = new Float32Array(pieces.ofVertex.length);
  const longest = new Float32Array(pieces.count);
  pieces.ofVertex.forEach((piece, v) => {
    if (first[piece] < 0) first[piece] = v;
    const f = first[piece] * 3;
    reach[v] = Math.hypot(
      positions[v * 3] - positions[f],
      positions[v * 3 + 1] - positions[f + 1],
      positions[v * 3 + 2] - positions[f + 2],
    );
    longest[piece] = Math.max(longest[piece], reach[v]);
  });
  return reach.map((r, v) => (longest[pieces.ofVertex[v]] > 0 ? r / longest[pieces.ofVertex[v]] : 0));
}
