import { expect, test } from "vitest";
import { addRows } from "../../../../web/player/src/core/modal/addRows";
import { seededRandom } from "../../seeded";

test("sums of rows of any width equal those computed column by column", () => {
  const next = seededRandom(17);
  const some = (length: number) => Float64Array.from({ length }, () => next() - 0.5);
  for (let width = 0; width <= 40; width++) {
    const rows = 1 + Math.floor(30 * next());
    const matrix = some((rows + 2) * width);
    const terms = some(rows + 2);
    const out = some(width);
    const expected = out.map((start, k) => {
      let sum = start;
      for (let row = 0; row < rows; row++) sum += matrix[row * width + k] * terms[row];
      return sum;
    });
    addRows(matrix, terms, rows, width, out);
    expect(out, `width ${width}`).toEqual(expected);
  }
});
