/** A triangle mesh as flat number lists, counter-clockwise seen from outside. */
export interface SurfaceMesh {
  positions: number[];
  normals: number[];
  uvs: number[];
  indices: number[];
  /** Linear RGB in [0, 1], one triple per vertex. */
  colours?: number[];
}
