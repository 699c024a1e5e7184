/** Single leaves of a tree, as the reader of a scene supplies them: shapes of sprays, and where each spray is. */
import type { MeshStandardMaterial } from "three";

/** The leaves of a spray with their shoot, in its frame: x across, y from its foot to its tip (0..1), z towards its upper side. */
export interface SprayShape {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly uvs: Float32Array;
  /** Of each vertex: the foot of its leaf, and a random number of the leaf in (0, 1]; 0: a vertex of the shoot, which does not flutter. */
  readonly leaves: Float32Array;
  readonly index: Uint16Array;
}

/**
 * Floats of a spray in the frame of its tree: foot, key of its limb | axis times length, random number | upper side, 1 or −1 (mirrored) |
 * normal of the crown, openness | colour, 0.
 */
export const SPRAY_FLOATS = 20;

/** The single leaves of a tree: all belong to one part. */
export interface SingleLeaves {
  readonly material: MeshStandardMaterial;
  readonly shapes: readonly SprayShape[];
  /** Shape of each spray. */
  readonly shapeOf: Uint8Array;
  /** Of each spray: the vertex of the mesh whose motion it takes. */
  readonly hold: Uint32Array;
  /** [sprays, SPRAY_FLOATS] */
  readonly sprays: Float32Array;
}
