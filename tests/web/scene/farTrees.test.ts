import type { TableMotion } from "galewood/client";
import type { View } from "galewood/trees";
import { PRESETS, WindField } from "galewood/wind";
import { InstancedBufferGeometry, Mesh, MeshLambertMaterial } from "three";
import { expect, test } from "vitest";
import { FarTrees } from "../../../web/src/scene/background/farTrees";
import { groundHeight_m } from "../../../web/src/scene/ground/landscape";
import { CARD_FLOATS, CardList, type Cards } from "../../../web/src/scene/impostors/cards";

const HEIGHT_M = 24;

const listOf = () => new CardList(new Mesh(new InstancedBufferGeometry(), new MeshLambertMaterial()));

/** Pictures of trees 24 m tall. */
const cardsOf = () => {
  const [seen, casting] = [listOf(), listOf()];
  const cards = { atlas: { box: { height_m: HEIGHT_M, reach: 1, across_m: 4 } }, seen, casting } as unknown as Cards;
  return { cards, seen };
};

const treesAt = (...x_m: number[]) =>
  new FarTrees(
    x_m.map((x, id) => ({ id, x_m: x, z_m: 0, yaw_rad: 0, scale: 1 })),
    { full_m: 500, least: 1 },
    () => [0, 0, 0, 0],
  );

/** What an eye sees this far along x from the origin and this high above it; everything nearer than 500 m is in view. */
const viewFrom = (x: number, above_m: number): View => ({
  planes: [],
  eye: { x, y: groundHeight_m(0, 0) + above_m, z: 0 },
  sun: { x: 0, y: 1, z: 0 },
  levelFrom_m: [10, 20],
  shadow_m: 0,
});

/** Opacity of the picture of a tree 24 m tall, for an eye this far beside it and this high above its base; 0 if it is not drawn. */
function opacity(beside_m: number, above_m: number): number {
  const { cards, seen } = cardsOf();
  treesAt(0).select(cards, viewFrom(beside_m, above_m));
  return seen.count === 0 ? 0 : seen.data[3];
}

test("pictures of trees dissolve before an eye beside them, and before one that flies over their crowns", () => {
  expect(opacity(20, 2)).toBe(0);
  expect(opacity(60, 2)).toBe(1);
  expect(opacity(0, 36)).toBe(0); // 12 m over the top, though 36 m from the base
  expect(opacity(0, 60)).toBe(1);
});

test("only trees that are seen move; one that comes into view is at rest in the wind", () => {
  const field = new WindField(PRESETS["storm-front"]);
  const motion = {
    height_m: HEIGHT_M,
    sway: { frequency_hz: 0.4, damping: 0.05, tip_m_pa: 0.001, streamlined: 1.3 },
  } as TableMotion;
  const trees = treesAt(0, 100);
  const { cards, seen } = cardsOf();
  /** Displacements along x of the tips of the cards, before and after the last step. */
  const tips = () => Array.from({ length: seen.count }, (_, k) => [seen.bend[4 * k], seen.bend[4 * k + 2]]);
  const step = (time_s: number) => trees.advance(0.1, time_s, field, motion, cards);
  trees.select(cards, viewFrom(5, 2)); // the first tree is too near for its picture
  step(1);
  expect(tips()).toHaveLength(1);
  for (let k = 2; k < 40; k++) step(1 + 0.1 * k);
  const [[before, after]] = tips();
  expect(Math.abs(after - before)).toBeGreaterThan(1e-5);
  trees.select(cards, viewFrom(50, 2));
  const moving = tips();
  expect(moving).toHaveLength(2);
  const still = moving.filter(([from, to]) => from === to);
  expect(still).toHaveLength(1);
  expect(Math.abs(still[0][0])).toBeGreaterThan(0.01); // where the wind holds it, not upright
  expect(moving.filter(([from, to]) => from !== to)[0][1]).toBe(after);
  step(5);
  expect(tips().filter(([from, to]) => from === to)).toEqual([]);
});

test("a list of cards grows with room to spare, and gives room back of which little is used", () => {
  const list = listOf();
  const floatsFor = (count: number) => {
    list.reserve(count);
    return list.data.length;
  };
  const many = floatsFor(5000);
  expect(many).toBeGreaterThan(CARD_FLOATS * 5000);
  expect(floatsFor(3000)).toBe(many);
  expect(floatsFor(500)).toBeLessThan(0.25 * many);
});
