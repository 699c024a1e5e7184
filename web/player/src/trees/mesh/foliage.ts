/** Precomputed shading of foliage: rounded normals, flutter weights. Pure. */
import { type Components, petioles } from "./components";

export interface Point {
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

/** A leaf of this length, m, flutters fully; a longer piece less, so that its tip does not sweep far. */
const FULL_LENGTH_M = 0.25;

/** Flutter weight of each leaf vertex, the same for a whole piece: 1 for small leaves, less for large pieces. */
export function leafFreedom(pieces: Components, positions: Float32Array): Float32Array {
  const bases = petioles(pieces, positions);
  const longest = new Float32Array(pieces.count);
  pieces.ofVertex.forEach((piece, v) => {
    const reach = Math.hypot(
      positions[v * 3] - bases[piece * 3],
      positions[v * 3 + 1] - bases[piece * 3 + 1],
      positions[v * 3 + 2] - bases[piece * 3 + 2],
    );
    longest[piece] = Math.max(longest[piece], reach);
  });
  const free = new Float32Array(pieces.ofVertex.length);
  for (let v = 0; v < free.length; v++)
    free[v] = Math.min(1, FULL_LENGTH_M / Math.max(longest[pieces.ofVertex[v]], 1e-6));
  return free;
}
