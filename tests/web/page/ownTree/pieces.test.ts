import { expect, test } from "vitest";
import { assumedOf } from "../../../../web/src/page/ownTree/assumed";
import { choicesWith, type Piece, rowsOfVertices, titleOf } from "../../../../web/src/page/ownTree/pieces";

const REPORT = {
  up_axis: { value: "z", reason: "a trunk", unsure: true },
  pieces: [
    { id: "0.0", names: ["bark", "node"], kind: "wood", reason: "a tube", faces: 90, pieces: 2, tree: 1, sure: true },
    { id: "1.0", names: [], kind: "leaves", reason: "green", faces: 40, pieces: 1, tree: 1, sure: false, colour: "#55a23d" },
    { id: "2.0", names: [], kind: "other", what: "pot", reason: "low", faces: 30, tree: 0, chosen: true, colour: "red" },
  ],
  trees: [
    { number: 1, height_m: 8, faces: 130, taken: true },
    { number: 2, height_m: 6, faces: 130, taken: false },
  ],
  vertex_pieces: [[0, 3], [1, 2, -1, 1]],
};

test("pieces, trees and doubts are read from the report", () => {
  const { pieces, trees, axis, vertexPieces } = assumedOf(REPORT);
  expect(pieces.map(({ id, kind }) => [id, kind])).toEqual([
    ["0.0", "wood"],
    ["1.0", "leaves"],
    ["2.0", "other"],
  ]);
  expect(pieces.map(titleOf)).toEqual(["Bark (2 pieces)", "Leaves", "Pot"]);
  expect(pieces.map(({ colour }) => colour)).toEqual([null, "#55a23d", null]);
  expect([axis.unsure, pieces[1].sure, pieces[2].chosen]).toEqual([true, false, true]);
  expect(trees.find(({ taken }) => taken)?.number).toBe(1);
  expect(vertexPieces).toEqual([[0, 3], [1, 2, -1, 1]]);
});

test("a report without pieces has none", () => {
  expect(assumedOf({ up_axis: {} })).toMatchObject({ pieces: [], trees: [], vertexPieces: [] });
});

test("a choice keeps the earlier ones and leaves what was detected alone", () => {
  const { pieces } = assumedOf(REPORT);
  expect(choicesWith(pieces, "1.0", "wood")).toEqual({ wood_parts: ["1.0"], leaves: null, drop: ["2.0"] });
  expect(choicesWith(pieces, "2.0", "leaves")).toEqual({ wood_parts: null, leaves: ["2.0"], drop: null });
  const twigs: Piece = { ...pieces[0], kind: "twigs" };
  expect(choicesWith([twigs], "0.0", "twigs")).toEqual({ wood_parts: null, leaves: null, drop: null });
});

test("runs of vertices name the row of each vertex", () => {
  expect([...rowsOfVertices([2, 3, -1, 1, 0, 2], 7)]).toEqual([2, 2, 2, -1, 0, 0, -1]);
});
