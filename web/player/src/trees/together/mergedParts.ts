/** Merges parts of wood into one that is drawn with one material: bark, twigs, and what is added to them. */
import { BufferAttribute } from "three";
import { LEVEL_COUNT } from "../detail";
import { ADDED_PART, type PlannedPart } from "../drawnParts";
import type { TreePart } from "../mesh/treeMesh";

/** Vertices are named by 16 bits in merged parts. */
const MOST_VERTICES = 65536;
/**
 * Texture coordinate of vertices whose part has no picture, in a part where others have one; the material leaves the picture out below
 * `UNMAPPED_BELOW`.
 */
const UNMAPPED_UV = -65536;
export const UNMAPPED_BELOW = -1024;

/** Wood without holes and without colours of its vertices, which take those of the materials. */
const isPlainWood = ({ part: { kind, colour, material } }: PlannedPart) =>
  kind === "wood" && !colour && material.alphaTest === 0 && !material.transparent;

/** Near parts of wood may be among what is always drawn, because no tree shows them once its leaves have fallen. */
const seasonOf = ({ season, near }: PlannedPart) => (near ? "always" : season);

/** Whether parts can be drawn with one material: only one of them has pictures, or all have the same. */
function fits(group: readonly PlannedPart[], one: PlannedPart): boolean {
  if (seasonOf(group[0]) !== seasonOf(one) || ![group[0], one].every(isPlainWood)) return false;
  const { material } = one.part;
  return group.every(({ part }) => {
    const unmapped = [part, one.part].some(isUnmapped);
    return unmapped || (part.material.map === material.map && part.material.normalMap === material.normalMap);
  });
}

const isUnmapped = ({ material }: TreePart) => !material.map && !material.normalMap;

function concatenated(
  parts: readonly TreePart[],
  size: number,
  valuesOf: (part: TreePart) => ArrayLike<number> | null,
  otherwise: (part: TreePart) => readonly number[] = () => [],
): BufferAttribute {
  const values = new Float32Array(size * parts.reduce((sum, { vertices }) => sum + vertices, 0));
  let to = 0;
  for (const part of parts) {
    const own = valuesOf(part);
    if (own) values.set(own, to);
    else for (let v = 0; v < part.vertices; v++) values.set(otherwise(part), to + size * v);
    to += size * part.vertices;
  }
  return new BufferAttribute(values, size);
}

/** The colour of the material at each vertex. */
function colouredBy({ material, vertices }: TreePart): Float32Array {
  const { r, g, b } = material.color;
  const factor = [r, g, b];
  return Float32Array.from({ length: 3 * vertices }, (_, i) => factor[i % 3]);
}

/** The index of all parts: first what the coarsest level draws, then what each finer one adds, then the near parts. */
function indexOf(plans: readonly PlannedPart[]): { index: BufferAttribute; counts: number[] } {
  const index = new Uint32Array(plans.reduce((sum, { part }) => sum + part.index.count, 0));
  const counts = new Array<number>(LEVEL_COUNT).fill(0);
  let to = 0;
  const take = (near: boolean, rangeOf: (part: TreePart) => readonly [number, number]) => {
    let firstVertex = 0;
    for (const plan of plans) {
      if (plan.near === near) {
        const [from, end] = rangeOf(plan.part);
        for (let i = from; i < end; i++) index[to++] = firstVertex + plan.part.index.array[i];
      }
      firstVertex += plan.part.vertices;
    }
  };
  for (let level = LEVEL_COUNT - 1; level >= 0; level--) {
    take(false, ({ counts: own }) => [own[level + 1] ?? 0, own[level]]);
    counts[level] = to;
  }
  take(true, (part) => [0, part.index.count]);
  return { index: new BufferAttribute(index, 1), counts };
}

function merge(plans: readonly PlannedPart[]): PlannedPart {
  const parts = plans.map(({ part }) => part);
  const mapped = parts.find((part) => !isUnmapped(part)) ?? parts[0];
  const material = mapped.material.clone();
  material.color.setRGB(1, 1, 1);
  material.userData = { ...material.userData, merged: true };
  const unmapped = () => [UNMAPPED_UV, UNMAPPED_UV];
  const uvOf = (part: TreePart) => (isUnmapped(part) ? null : (part.uv?.array ?? null));
  const holds = plans.flatMap(({ part, firstVertex }) => Array.from(part.hold, (v) => firstVertex + v));
  return {
    part: {
      kind: "wood",
      vertices: holds.length,
      material,
      position: concatenated(parts, 3, ({ position }) => position.array),
      normal: concatenated(parts, 3, ({ normal }) => normal.array),
      uv: isUnmapped(mapped) ? null : concatenated(parts, 2, uvOf, unmapped),
      colour: concatenated(parts, 3, colouredBy),
      anchor: concatenated(parts, 4, ({ anchor }) => anchor.array),
      piece: concatenated(parts, 4, ({ piece }) => piece.array),
      hold: Uint32Array.from(holds),
      ...indexOf(plans),
    },
    firstVertex: 0,
    pullFirst: ADDED_PART,
    season: seasonOf(plans[0]),
    near: false,
  };
}

/** The parts that are drawn, in their order; one of several parts takes the place of its first. */
export function mergedParts(plans: readonly PlannedPart[]): PlannedPart[] {
  const ends = plans.map(
    ({ part, firstVertex }) => firstVertex + part.hold.reduce((a, b) => Math.max(a, b), 0),
  );
  if (ends.some((vertex) => vertex >= MOST_VERTICES)) return [...plans];
  const groups: PlannedPart[][] = [];
  for (const plan of plans) {
    const group = groups.find((one) => fits(one, plan));
    if (group) group.push(plan);
    else groups.push([plan]);
  }
  return groups.map((group) => (group.length === 1 ? group[0] : merge(group)));
}
