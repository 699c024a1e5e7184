import { InstancedBufferGeometry, Mesh, MeshLambertMaterial } from "three";
import { expect, test } from "vitest";
import { FarTrees } from "../../../web/src/scene/background/farTrees";
import { groundHeight_m } from "../../../web/src/scene/ground/landscape";
import { CardList, type Cards } from "../../../web/src/scene/impostors/cards";

const HEIGHT_M = 24;

const listOf = () => new CardList(new Mesh(new InstancedBufferGeometry(), new MeshLambertMaterial()));

/** Opacity of the picture of a tree 24 m tall, for an eye this far beside it and this high above its base; 0 if it is not drawn. */
function opacity(beside_m: number, above_m: number): number {
  const trees = new FarTrees(
    [{ id: 3, x_m: 0, z_m: 0, yaw_rad: 0, scale: 1 }],
    { full_m: 500, least: 1 },
    () => [0, 0, 0, 0],
  );
  const seen = listOf();
  const cards = {
    atlas: { box: { height_m: HEIGHT_M, reach: 1, across_m: 4 } },
    seen,
    casting: listOf(),
  } as unknown as Cards;
  trees.select(cards, {
    planes: [], // everything is in view
    eye: { x: beside_m, y: groundHeight_m(0, 0) + above_m, z: 0 },
    sun: { x: 0, y: 1, z: 0 },
    levelFrom_m: [10, 20],
    shadow_m: 0,
  });
  return seen.count === 0 ? 0 : seen.data[3];
}

test("pictures of trees dissolve before an eye beside them, and before one that flies over their crowns", () => {
  expect(opacity(20, 2)).toBe(0);
  expect(opacity(60, 2)).toBe(1);
  expect(opacity(0, 36)).toBe(0); // 12 m over the top, though 36 m from the base
  expect(opacity(0, 60)).toBe(1);
});
