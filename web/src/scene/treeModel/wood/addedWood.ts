/** What is drawn over the wood of a built-in tree: the flare at the foot of its stem, the collars of its boughs, dead branches. */
import { COMMON_KEY, type PartArrays, type ReadPart, rankedIndex } from "galewood/trees";
import { meanColour } from "../meanColour";
import { vertexNormals } from "../points";
import { branchCollars } from "./collars";
import { type DeadBranches, deadBranches } from "./deadBranches";
import { type FlareMesh, rootFlare, type Wood } from "./rootFlare";
import { type BranchMesh, tubesOf } from "./tubes";

/** The flare is drawn until a tree shows about this share of its pieces. */
const FLARE_RANK = 0.3;
/** The same of collars and dead branches: those of trees at the finest level of detail are drawn, no others. */
const COLLAR_RANK = 0.6;

/** What is drawn in addition to a part of the file. Its `hold` names vertices of that part. */
export interface AddedArrays {
  readonly part: PartArrays;
  /** Index of the part. */
  readonly of: number;
}

/** Vertices that all have the mean of other colours. */
export function evenColour(of: Float32Array | null, vertices: number): Float32Array | null {
  const mean = meanColour(of);
  return mean && Float32Array.from({ length: 3 * vertices }, (_, i) => mean[i % 3]);
}

/** Normals of a flare, which become those of the stem towards its top, so that no edge is seen there. */
function flareNormals({ positions, stemNormals, share, index }: FlareMesh): Float32Array {
  return vertexNormals(positions, index).map((n, i) => {
    const left = share[Math.floor(i / 3)];
    return left * n + (1 - left) * stemNormals[i];
  });
}

/** A mesh that is drawn over wood, each vertex moved by one of the wood's. */
interface OverWood extends Omit<BranchMesh, "uvs"> {
  readonly uvs: Float32Array | null;
}

/**
 * The mesh as a part. The rest by its vertices: where they shrink to with the key of their limb, their rank, and the soil on them,
 * which takes the place of the freedom to flutter that wood does not have.
 */
function partOver(
  part: PartArrays,
  mesh: OverWood,
  anchors: Float32Array,
  ranks: ArrayLike<number>,
  soil: ArrayLike<number>,
): PartArrays {
  const { positions, normals, uvs, index, hold } = mesh;
  const vertices = hold.length;
  const pieces = new Float32Array(4 * vertices);
  hold.forEach((v, k) => {
    pieces.set([part.pieces[4 * v], part.pieces[4 * v + 1], soil[k], ranks[k]], 4 * k);
  });
  return {
    kind: part.kind,
    vertices,
    normals,
    uvs,
    colours: evenColour(part.colours, vertices),
    positions,
    anchors,
    pieces,
    hold,
    ...rankedIndex(index, (k) => ranks[k]),
  };
}

/** Two meshes as one, which takes one draw call; both or none have a texture. */
function together(a: OverWood, b: OverWood): OverWood {
  const first = a.hold.length;
  return {
    positions: Float32Array.of(...a.positions, ...b.positions),
    normals: Float32Array.of(...a.normals, ...b.normals),
    uvs: a.uvs && b.uvs && Float32Array.of(...a.uvs, ...b.uvs),
    index: Uint32Array.of(...a.index, ...b.index.map((v) => first + v)),
    hold: Uint32Array.of(...a.hold, ...b.hold),
  };
}

/** Where the vertices of a mesh shrink to with the keys of their limbs (4 numbers of each), and their ranks. */
interface Shrinking {
  readonly anchors: Float32Array;
  readonly ranks: Float32Array;
}

/** The flare stays whole on all trees. */
const ofFlare = ({ hold }: OverWood): Shrinking => ({
  anchors: Float32Array.from({ length: 4 * hold.length }, (_, i) => (i % 4 === 3 ? COMMON_KEY : 0)),
  ranks: new Float32Array(hold.length).fill(FLARE_RANK),
});

/** A collar shrinks with its bough, and earlier than most. */
function ofCollars({ hold }: OverWood, of: PartArrays): Shrinking {
  const anchors = new Float32Array(4 * hold.length);
  hold.forEach((v, k) => {
    anchors.set(of.anchors.subarray(4 * v, 4 * v + 4), 4 * k);
  });
  return { anchors, ranks: Float32Array.from(hold, (v) => Math.max(COLLAR_RANK, of.pieces[4 * v + 3])) };
}

/** A dead branch shrinks into the stem; some are missing on each tree. */
const ofDead = ({ hold, feet }: DeadBranches): Shrinking => ({
  anchors: feet,
  ranks: new Float32Array(hold.length).fill(COLLAR_RANK),
});

/** Flare, collars and dead branches of a tree; none where the stem has no round base or the branches are no tubes. */
export function addedWood(read: readonly ReadPart[], evergreen: boolean): AddedArrays[] {
  const of = read.findIndex((one) => one.geometry.kind === "wood");
  if (of < 0) return [];
  const { part, geometry } = read[of];
  const wood: Wood = { ...part, index: geometry.index };
  const flare = rootFlare(wood);
  const tubes = tubesOf(wood, geometry.pieces.ofVertex);
  const collars = branchCollars(wood, tubes);
  const dead = deadBranches(wood, tubes, evergreen);
  const meshes: [OverWood, Shrinking][] = [];
  if (flare) {
    const foot = { ...flare, normals: flareNormals(flare) };
    meshes.push([foot, ofFlare(foot)]);
  }
  if (collars) meshes.push([collars, ofCollars(collars, part)]);
  if (dead) meshes.push([dead, ofDead(dead)]);
  if (meshes.length === 0) return [];
  const mesh = meshes.map(([one]) => one).reduce(together);
  const soil = new Float32Array(mesh.hold.length);
  soil.set(flare?.soil ?? []);
  const anchors = Float32Array.from(meshes.flatMap(([, shrinking]) => [...shrinking.anchors]));
  const ranks = Float32Array.from(meshes.flatMap(([, shrinking]) => [...shrinking.ranks]));
  return [{ part: partOver(part, mesh, anchors, ranks, soil), of }];
}
