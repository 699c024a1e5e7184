/** Parts of wood that are drawn with one call, and the joints of their vertices at every level of detail. */
import { BufferAttribute, MeshStandardMaterial, Texture } from "three";
import { expect, test } from "vitest";
import type { DrawnMotion, NodeLevel } from "../../../../web/player/src/core/table/drawnTable";
import { LEVEL_COUNT, NEAR_RANK, rankedIndex } from "../../../../web/player/src/trees/detail";
import { ADDED_PART, type PlannedPart } from "../../../../web/player/src/trees/drawnParts";
import { jointAttribute } from "../../../../web/player/src/trees/jointAttribute";
import type { Part } from "../../../../web/player/src/trees/mesh/partArrays";
import { mergedParts, UNMAPPED_BELOW } from "../../../../web/player/src/trees/together/mergedParts";
import { jointsOf } from "../../../../web/player/src/trees/together/togetherMeshes";
import { random } from "../../golden";

const SEED = 17;
const TRIANGLES = 40;

interface Given {
  readonly kind?: Part;
  readonly material: MeshStandardMaterial;
  readonly firstVertex: number;
  readonly near?: boolean;
}

/** A part of triangles with random places and ranks. */
function partOf(next: () => number, { kind = "wood", material, firstVertex, near = false }: Given): PlannedPart {
  const vertices = 3 * TRIANGLES;
  const filled = (columns: number) => new BufferAttribute(Float32Array.from({ length: vertices * columns }, next), columns);
  const piece = filled(4);
  for (let triangle = 0; triangle < TRIANGLES; triangle++) {
    const rank = near ? NEAR_RANK + 0.5 * next() : next();
    for (let corner = 0; corner < 3; corner++) piece.setW(3 * triangle + corner, rank);
  }
  const ranked = rankedIndex(
    Uint32Array.from({ length: vertices }, (_, v) => v),
    (v) => piece.getW(v),
  );
  const part = {
    kind,
    vertices,
    material,
    position: filled(3),
    normal: filled(3),
    uv: material.map ? filled(2) : null,
    colour: null,
    anchor: filled(4),
    piece,
    hold: Uint32Array.from({ length: vertices }, (_, v) => 3 * Math.floor(v / 3)),
    index: new BufferAttribute(ranked.index, 1),
    counts: ranked.counts,
  };
  return { part, firstVertex, pullFirst: firstVertex, season: near ? "leafy" : "always", near };
}

const bark = () => new MeshStandardMaterial({ map: new Texture(), color: 0x886644 });
const plain = (color: number) => new MeshStandardMaterial({ color });

/** What is drawn of a run of indices: place, anchor and the vertex that each corner is held by, in any order. */
function drawn({ part, firstVertex }: PlannedPart, from: number, end: number): string[] {
  const corners = Array.from(part.index.array.subarray(from, end), (v) =>
    [part.position.getX(v), part.position.getY(v), part.anchor.getW(v), part.piece.getW(v), firstVertex + part.hold[v]].join(),
  );
  return Array.from({ length: corners.length / 3 }, (_, k) => corners.slice(3 * k, 3 * k + 3).join(" ")).sort();
}

test(`a merged part draws at every level what its parts draw (seed ${SEED})`, () => {
  const next = random(SEED);
  const twigs = plain(0x335577);
  const plans = [
    partOf(next, { material: bark(), firstVertex: 0 }),
    partOf(next, { material: twigs, firstVertex: 3 * TRIANGLES }),
    partOf(next, { kind: "leaves", material: plain(0x00ff00), firstVertex: 6 * TRIANGLES }),
    partOf(next, { material: twigs, firstVertex: 6 * TRIANGLES, near: true }),
  ];
  const merged = mergedParts(plans);
  expect(merged.map(({ part }) => part.kind)).toEqual(["wood", "leaves"]);
  expect(merged[1]).toBe(plans[2]);
  const [wood] = merged;
  const apart = [plans[0], plans[1]];
  for (let level = 0; level < LEVEL_COUNT; level++) {
    const expected = apart.flatMap((one) => drawn(one, 0, one.part.counts[level])).sort();
    expect(drawn(wood, 0, wood.part.counts[level])).toEqual(expected);
  }
  expect(drawn(wood, wood.part.counts[0], wood.part.index.count)).toEqual(drawn(plans[3], 0, 3 * TRIANGLES));
  expect([wood.pullFirst, wood.season, wood.near]).toEqual([ADDED_PART, "always", false]);
});

test("vertices of a merged part have the colour of their material, and no place in a picture if that has none", () => {
  const next = random(SEED);
  const materials = [plain(0x335577), bark()];
  const [{ part }] = mergedParts(materials.map((material, k) => partOf(next, { material, firstVertex: 3 * k * TRIANGLES })));
  for (let v = 0; v < part.vertices; v++) {
    const own = materials[v < 3 * TRIANGLES ? 0 : 1];
    const colour = [part.colour?.getX(v), part.colour?.getY(v), part.colour?.getZ(v)];
    expect(colour).toEqual([...Float32Array.from(own.color.toArray())]);
    expect((part.uv?.getX(v) ?? 0) > UNMAPPED_BELOW).toBe(own.map !== null);
  }
  expect([part.material.map, part.material.color.getHex()]).toEqual([materials[1].map, 0xffffff]);
});

test("what needs a material of its own stays apart", () => {
  const next = random(SEED);
  const pictures = [bark(), bark()].map((material, k) => partOf(next, { material, firstVertex: 3 * k * TRIANGLES }));
  expect(mergedParts(pictures)).toEqual(pictures);
  const holed = [plain(1), Object.assign(plain(1), { alphaTest: 0.5 })].map((material, k) =>
    partOf(next, { material, firstVertex: 3 * k * TRIANGLES }),
  );
  expect(mergedParts(holed)).toEqual(holed);
  const many = [0, 70_000].map((firstVertex) => partOf(next, { material: plain(1), firstVertex }));
  expect(mergedParts(many), "vertices that 16 bits cannot name").toEqual(many);
});

test(`the joints of all levels are those of each (seed ${SEED})`, () => {
  const next = random(SEED);
  const planned = partOf(next, { material: plain(1), firstVertex: 5 });
  const nodes = 32;
  const vertices = planned.firstVertex + planned.part.vertices;
  const pick = (below: number) => Math.floor(below * next());
  // each level merges nodes of the one before
  const levels = Array.from({ length: LEVEL_COUNT }, (_, level) => ({
    of: Uint16Array.from({ length: nodes }, (_, node) => node >> level),
  })) as unknown as NodeLevel[];
  const motion = {
    levels,
    vertexJoint: Uint16Array.from({ length: vertices }, () => pick(20)),
    jointNodes: Uint16Array.from({ length: 40 }, () => pick(nodes)),
    jointShare: Float32Array.from({ length: 20 }, () => (next() < 0.3 ? 0 : next())),
  } as unknown as DrawnMotion;
  const { aJoints0, aJoints12, aJoints34 } = jointsOf(planned, motion);
  for (let level = 0; level < LEVEL_COUNT; level++) {
    const alone = jointAttribute(planned.part, planned.firstVertex, motion, levels[level]);
    const of = level === 0 ? aJoints0 : level < 3 ? aJoints12 : aJoints34;
    const at = level === 2 || level === 4 ? 2 : 0;
    for (let v = 0; v < planned.part.vertices; v++) {
      const [first, second] = [of.getComponent(v, at), of.getComponent(v, at + 1)];
      const share = first === second ? 0 : aJoints0.getZ(v);
      expect([first, second, share, aJoints0.getW(v)]).toEqual([0, 1, 2, 3].map((k) => alone.getComponent(v, k)));
    }
  }
});
