/** Painting pieces: strokes, undo, ranges, and the pieces under a brush. */
import { expect, test } from "vitest";
import { assumedOf } from "../../../../web/src/page/ownTree/assumed";
import { type RowPicture, rowsUnder } from "../../../../web/src/page/ownTree/painting/brush";
import { PaintedKinds, type PieceTable, rangesOf, rowsOf } from "../../../../web/src/page/ownTree/painting/paintedKinds";
import { choicesWith } from "../../../../web/src/page/ownTree/pieces";
import { heightOf, namesOf } from "../../../../web/src/page/ownTree/severalTrees";
import { seededRandom } from "../../seeded";

const TABLE: PieceTable = {
  part: [0, 0, 0, 1, 1, 1, 1],
  number: [0, 1, 2, 0, 1, 2, 5],
  kind: ["wood", "wood", "twigs", "leaves", "leaves", "leaves", "other"],
};

test("ranges name rows, and rows ranges", () => {
  expect(rangesOf(TABLE, [5, 0, 3, 2, 4, 6])).toEqual(["0.0-0", "0.2-2", "1.0-2", "1.5-5"]);
  expect(rowsOf(TABLE, ["1.1-7", "0.2-2"])).toEqual([2, 4, 5, 6]);
  const random = seededRandom(5);
  for (let k = 0; k < 50; k++) {
    const rows = TABLE.part.map((_, row) => row).filter(() => random() < 0.5);
    expect(rowsOf(TABLE, rangesOf(TABLE, rows))).toEqual(rows);
  }
});

test("strokes are undone and redone whole; a stroke that changes nothing is none", () => {
  const kinds = new PaintedKinds(TABLE);
  kinds.begin("leaves");
  expect(kinds.paint([3])).toEqual([]);
  kinds.end();
  expect(kinds.canUndo).toBe(false);
  kinds.begin("other");
  expect(kinds.paint([3, 4])).toEqual([3, 4]);
  expect(kinds.paint([4, 0])).toEqual([0]);
  kinds.end();
  kinds.begin("wood");
  kinds.paint([4]);
  kinds.end();
  expect(kinds.changed).toEqual([0, 3, 4]);
  kinds.undo();
  expect(kinds.kindOf(4)).toBe("other");
  kinds.undo();
  expect([kinds.changed, kinds.canUndo, kinds.canRedo]).toEqual([[], false, true]);
  kinds.redo();
  expect(kinds.changed).toEqual([0, 3, 4]);
  kinds.begin("leaves");
  kinds.paint([0]);
  kinds.cancel();
  expect(kinds.kindOf(0)).toBe("other");
  expect(kinds.canRedo).toBe(true);
});

test("painted pieces join the choices that were made before", () => {
  const { pieces } = assumedOf({
    up_axis: {},
    pieces: [
      { id: "0.0", kind: "other", faces: 1, chosen: true },
      { id: "1.1-2", kind: "wood", faces: 1, chosen: true, ranges: ["1.1-2"] },
      { id: "1.0", kind: "leaves", faces: 1 },
    ],
  });
  const kinds = new PaintedKinds({ ...TABLE, kind: ["other", "other", "other", "leaves", "wood", "wood", "other"] });
  kinds.begin("leaves");
  kinds.paint([5]);
  kinds.end();
  kinds.begin("wood");
  kinds.paint([0]);
  kinds.end();
  expect(kinds.choices(pieces)).toEqual({
    wood_parts: ["0.0-0", "1.1-1"],
    leaves: ["1.2-2"],
    drop: ["0.0"],
  });
  expect(choicesWith(pieces, "1.1-2", "other")).toEqual({
    wood_parts: null,
    leaves: null,
    drop: ["0.0", "1.1-2"],
  });
});

test("a brush finds the rows within its radius of the line, as a search of all pixels does", () => {
  const random = seededRandom(9);
  const [width, height] = [31, 23];
  const pixels = Uint8Array.from({ length: 4 * width * height }, (_, k) => (k % 4 === 0 ? 40 * random() : k % 4 === 1 ? 2 * random() : 0));
  const picture: RowPicture = { width, height, pixels };
  for (let k = 0; k < 8; k++) {
    const place = () => ({ x: width * random(), y: height * random() });
    const [from, to, radius] = [place(), place(), 1 + 6 * random()];
    const expected = new Set<number>();
    for (let y = 0; y < height; y++)
      for (let x = 0; x < width; x++) {
        const near = Array.from({ length: 201 }, (_, n) => n / 200).some(
          (t) => Math.hypot(x - from.x - t * (to.x - from.x), y - from.y - t * (to.y - from.y)) <= radius,
        );
        const at = 4 * ((height - 1 - y) * width + x);
        const row = pixels[at] + 256 * pixels[at + 1] - 1;
        if (near && row >= 0) expected.add(row);
      }
    const found = rowsUnder(picture, from, to, radius);
    expect([...expected].filter((row) => !found.has(row))).toEqual([]);
    // the line of the search has gaps of a fifth of a pixel
    const wider = rowsUnder(picture, from, to, radius - 0.1);
    expect([...wider].filter((row) => !expected.has(row))).toEqual([]);
  }
});

test("several trees are named by what only they are called, or numbered", () => {
  const trees = ["oak", "", "pine", "pine"].map((name, k) => ({
    number: k + 1,
    name,
    height_m: 5,
    faces: 1,
    taken: k === 0,
  }));
  expect(namesOf("garden", trees)).toEqual(["garden, oak", "garden 2", "garden 3", "garden 4"]);
  const given = assumedOf({ up_axis: {}, unit: { value: "given" } });
  const metres = assumedOf({ up_axis: {}, unit: { value: "m" } });
  expect([heightOf(given, trees[0]), heightOf(metres, trees[0])]).toEqual([5, null]);
});
