/** What is drawn over the wood of a built-in tree: the flare at the foot of its stem, the collars of its boughs, dead branches. */
import { type AddedPart, COMMON_KEY, type ReadPart, rankedIndex, type TreePart } from "galewood/trees";
import { BufferAttribute, BufferGeometry } from "three";
import { branchCollars } from "./collars";
import { type DeadBranches, deadBranches } from "./deadBranches";
import { meanColour } from "./meanColour";
import { type FlareMesh, rootFlare, type Wood } from "./rootFlare";
import { type BranchMesh, tubesOf } from "./tubes";

/** The flare is drawn until a tree shows about this share of its pieces. */
const FLARE_RANK = 0.3;
/** The same of collars and dead branches: those of trees at the finest level of detail are drawn, no others. */
const COLLAR_RANK = 0.6;

/** Vertices that all have the mean of other colours. */
export function evenColour(of: BufferAttribute | null, vertices: number): BufferAttribute | null {
  const mean = meanColour(of);
  if (!mean) return null;
  return new BufferAttribute(
    Float32Array.from({ length: 3 * vertices }, (_, i) => mean[i % 3]),
    3,
  );
}

/** Normals of a flare, which become those of the stem towards its top, so that no edge is seen there. */
function flareNormals({ positions, stemNormals, share, index }: FlareMesh): Float32Array {
  const bent = new BufferGeometry();
  bent.setAttribute("position", new BufferAttribute(positions, 3));
  bent.setIndex(new BufferAttribute(index, 1));
  bent.computeVertexNormals();
  const own = bent.getAttribute("normal").array;
  return Float32Array.from(own, (n, i) => {
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
  part: TreePart,
  mesh: OverWood,
  anchor: Float32Array,
  ranks: ArrayLike<number>,
  soil: ArrayLike<number>,
): TreePart {
  const { positions, normals, uvs, index, hold } = mesh;
  const vertices = hold.length;
  const piece = new Float32Array(4 * vertices);
  hold.forEach((v, k) => {
    piece.set([part.piece.getX(v), part.piece.getY(v), soil[k], ranks[k]], 4 * k);
  });
  const ranked = rankedIndex(index, (k) => ranks[k]);
  return {
    ...part,
    vertices,
    normal: new BufferAttribute(normals, 3),
    uv: uvs && new BufferAttribute(uvs, 2),
    colour: evenColour(part.colour, vertices),
    position: new BufferAttribute(positions, 3),
    anchor: new BufferAttribute(anchor, 4),
    piece: new BufferAttribute(piece, 4),
    hold,
    index: new BufferAttribute(ranked.index, 1),
    counts: ranked.counts,
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
function ofCollars({ hold }: OverWood, { anchor, piece }: TreePart): Shrinking {
  const anchors = new Float32Array(4 * hold.length);
  const ofWood = anchor.array as Float32Array;
  hold.forEach((v, k) => {
    anchors.set(ofWood.subarray(4 * v, 4 * v + 4), 4 * k);
  });
  return { anchors, ranks: Float32Array.from(hold, (v) => Math.max(COLLAR_RANK, piece.getW(v))) };
}

/** A dead branch shrinks into the stem; some are missing on each tree. */
const ofDead = ({ hold, feet }: DeadBranches): Shrinking => ({
  anchors: feet,
  ranks: new Float32Array(hold.length).fill(COLLAR_RANK),
});

/** Flare, collars and dead branches of a tree; none where the stem has no round base or the branches are no tubes. */
export function addedWood(read: readonly ReadPart[], evergreen: boolean): AddedPart[] {
  const of = read.findIndex((one) => one.geometry.kind === "wood");
  if (of < 0) return [];
  const { part, geometry } = read[of];
  const wood: Wood = {
    positions: part.position.array as Float32Array,
    normals: part.normal.array as Float32Array,
    uvs: (part.uv?.array as Float32Array | undefined) ?? null,
    index: geometry.index,
  };
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
