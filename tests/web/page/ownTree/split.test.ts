import { expect, test } from "vitest";
import { assumedOf } from "../../../../web/src/page/ownTree/assumed";
import { leftOutFaces, unsureVertices } from "../../../../web/src/page/ownTree/split";

const row = { names: [], reason: "green", faces: 4, pieces: 1, tree: 1 };
const { pieces } = assumedOf({
  up_axis: {},
  pieces: [
    { ...row, id: "0.0", kind: "wood", sure: true },
    { ...row, id: "1.0", kind: "leaves", sure: false },
    { ...row, id: "2.0", kind: "leaves", sure: false, chosen: true },
  ],
  trees: [],
  vertex_pieces: [],
});

test("vertices of uncertain pieces are hatched, unless the visitor has decided", () => {
  expect([...unsureVertices(Int32Array.of(0, 1, 1, 2, -1), pieces)]).toEqual([0, 1, 1, 0, 0]);
});

test("faces that are left out are kept for the red picture, all others are not", () => {
  const kinds = ["wood", "other", "leaves"];
  const index = [0, 1, 2, 3, 4, 5, 6, 7, 8];
  expect(leftOutFaces(index, (vertex) => Math.floor(vertex / 3), kinds)).toEqual([3, 4, 5]);
});
