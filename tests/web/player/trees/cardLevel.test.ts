import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { LONGEST_LINK } from "../../../../web/player/src/core/constants";
import { bendNodes } from "../../../../web/player/src/core/table/cardLevel";
import type { NodeLevel } from "../../../../web/player/src/core/table/drawnTable";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { CARD_LEVEL, LEVEL_COUNT } from "../../../../web/player/src/trees/detail";
import { tableMotion } from "../../../../web/player/src/worker/table/tableMotion";
import { random } from "../../golden";

const SEED = 5;

/** Where a node of a level is drawn, relative to its place at rest: see SHORTEN_LINKS_GLSL. */
function displaced({ basis, rest_m, parent, quads }: NodeLevel, node: number, q: ArrayLike<number>): number[] {
  const sumAt = (at: number, axis: number) =>
    Array.from(q, (value, k) => value * basis[(at * 3 + axis) * 4 * quads + k]).reduce((a, b) => a + b);
  const movedAt = (at: number) => [0, 1, 2].map((axis) => sumAt(at, axis));
  const moved = movedAt(node);
  for (let own = node; parent[own] !== own; own = parent[own]) {
    const [limb, end] = [movedAt(parent[own]), movedAt(own)];
    const link = [0, 1, 2].map((axis) => rest_m[3 * own + axis] - rest_m[3 * parent[own] + axis]);
    const now = link.map((length, axis) => length + end[axis] - limb[axis]);
    const excess = Math.max(0, 1 - (LONGEST_LINK * Math.hypot(...link)) / Math.hypot(...now));
    for (let axis = 0; axis < 3; axis++) moved[axis] -= excess * now[axis];
  }
  return moved;
}

test.each(["poplar", "oak", "spruce-forest"])(
  `%s: a card bends as the tree of the coarsest mesh did, also where links are shortened (seed ${SEED})`,
  (species) => {
    const next = random(SEED);
    const file = new URL(`../../../../assets/species/shipped/${species}.table`, import.meta.url);
    const { levels, rest_m, height_m } = tableMotion("", decodeTable(new Uint8Array(readFileSync(file))), 0);
    const [mesh, card] = [levels[LEVEL_COUNT - 1], levels[CARD_LEVEL]];
    expect(card.coordinates).toEqual(mesh.coordinates);
    expect(card.nodes).toBeLessThan(0.5 * mesh.nodes);
    const { middle, tip } = bendNodes({ rest_m, height_m });
    let most_m = 0;
    for (let round = 0; round < 20; round++) {
      const q = Float64Array.from(mesh.coordinates, () => 4 * height_m * (next() - 0.5));
      for (const node of [middle, tip]) {
        const moved = displaced(card, card.of[node], q);
        expect(moved).toEqual(displaced(mesh, mesh.of[node], q));
        most_m = Math.max(most_m, Math.hypot(...moved));
      }
    }
    expect(most_m).toBeGreaterThan(0.1 * height_m);
  },
);
