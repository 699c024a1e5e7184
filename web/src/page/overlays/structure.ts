/** The finite elements and the skeleton of a tree, fetched once per mesh. */
import { fetchApi, type Tree } from "../server/api";

export interface Structure {
  /** xyz of every vertex of the finite elements, m, tree frame; `edges` are pairs of them. */
  readonly vertices_m: Float32Array;
  readonly edges: Uint32Array;
  /** Number of tetrahedra. */
  readonly tets: number;
  /** xyz of every point of the skeleton; `links` are pairs of points. */
  readonly points_m: Float32Array;
  readonly links: Uint32Array;
}

interface Answer {
  vertices_m: number[][];
  tets: number[][];
  skeleton: { points_m: number[][]; parent: number[] };
}

/** Every edge of the tetrahedra once. */
export function edgesOf(tets: readonly (readonly number[])[], vertices: number): Uint32Array {
  const keys = new Set<number>();
  for (const tet of tets)
    for (let a = 0; a < 4; a++)
      for (let b = a + 1; b < 4; b++)
        keys.add(Math.min(tet[a], tet[b]) * vertices + Math.max(tet[a], tet[b]));
  return Uint32Array.from([...keys].flatMap((key) => [Math.floor(key / vertices), key % vertices]));
}

/** Every point of a skeleton with the one that it grows from. */
export const linksOf = (parent: readonly number[]): Uint32Array =>
  Uint32Array.from(parent.flatMap((above, point) => (above < 0 ? [] : [above, point])));

const known = new Map<string, Promise<Structure>>();

async function load(id: string): Promise<Structure> {
  const path = `api/trees/${encodeURIComponent(id)}/structure`;
  const { vertices_m, tets, skeleton } = (await (await fetchApi(path)).json()) as Answer;
  return {
    vertices_m: Float32Array.from(vertices_m.flat()),
    edges: edgesOf(tets, vertices_m.length),
    tets: tets.length,
    points_m: Float32Array.from(skeleton.points_m.flat()),
    links: linksOf(skeleton.parent),
  };
}

/** Throws a Problem if the server does not have it; it is asked again the next time. */
export function structureOf({ id, mesh_sha256 }: Tree): Promise<Structure> {
  const key = `${id} ${mesh_sha256}`;
  const found = known.get(key) ?? load(id);
  known.set(key, found);
  found.catch(() => known.delete(key));
  return found;
}
