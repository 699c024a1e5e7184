/** The nodes by which impostors bend, beside all nodes of the table. */
import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { NodePose } from "../../../../web/player/src/core/motion/nodePose";
import type { NodeLevel } from "../../../../web/player/src/core/table/drawnTable";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { CARD_LEVEL } from "../../../../web/player/src/trees/detail";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { tableMotion } from "../../../../web/player/src/worker/table/tableMotion";

/** Where a node of a level is drawn that has no links, relative to its place at rest. */
const displaced = ({ basis, quads, coordinates }: NodeLevel, node: number, poses: ArrayLike<number>): number[] =>
  [0, 1, 2].map((axis) =>
    coordinates.reduce((sum, mode, k) => sum + basis[(node * 3 + axis) * 4 * quads + k] * poses[mode], 0),
  );

/** Poses of one tree in a storm, two a second. */
function* storm(species: string, file: Uint8Array) {
  const placement = Float32Array.of(0, 0, 0, 1);
  const table = decodeTable(file);
  const group = { key: species, table, records: null, ids: Uint32Array.of(0), placement, sha256: "", compliance: null };
  const motion = new LocalMotion([group], new WindField(PRESETS["storm-front"]), { method: "modal", poseEasing: null }, 0);
  const poses = new Float32Array(tableMotion("", table, 0).stride);
  motion.see([0, 0]);
  for (let frame = 1; frame <= 3600; frame++) {
    motion.advance(1 / 30, [poses]);
    if (frame % 15 === 0) yield poses;
  }
}

test.each(["poplar", "oak", "spruce-forest", "willow.bare"])("%s: an impostor bends in a storm as all nodes of the table do", (species) => {
  const file = new Uint8Array(readFileSync(`assets/species/shipped/${species}.table`));
  const drawn = tableMotion("", decodeTable(file), 0);
  const { levels } = drawn;
  const exact = new NodePose(drawn);
  const [card, mesh] = [levels[CARD_LEVEL], levels[CARD_LEVEL - 1]];
  for (const [k, node] of card.bend.entries()) expect(card.parent[node]).toBe(k);
  const apart = [0, 0];
  let tip = 0;
  for (const poses of storm(species, file)) {
    const { moved } = exact.take(poses);
    levels[0].bend.forEach((node, k) => {
      const own = displaced(card, card.bend[k], poses);
      expect(own, "as while its mesh was still seen").toEqual(displaced(mesh, mesh.bend[k], poses));
      apart[k] += own.reduce((sum, at, axis) => sum + (at - moved[3 * node + axis]) ** 2, 0);
      if (k === 1) tip += moved.subarray(3 * node, 3 * node + 3).reduce((sum, at) => sum + at ** 2, 0);
    });
  }
  for (const one of apart) expect(Math.sqrt(one / tip)).toBeLessThan(0.15);
});
