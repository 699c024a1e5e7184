import { expect, test } from "vitest";
import { DetailBudget } from "../../../web/src/scene/detailBudget";
import { seededRandom } from "../seeded";

const MOST = 2.5e6;

/** Triangles of trees: some in any case, the others by the area within reach. */
const forestOf = (always: number, byArea: number) => (reach: number) => always + byArea * reach * reach;

function settle(budget: DetailBudget, trianglesAt: (reach: number) => number): number {
  let changes = 0;
  while (budget.take(trianglesAt(budget.reach), MOST)) if (++changes > 100) break;
  return changes;
}

test("detail that keeps to the budget reaches as far as it is set", () => {
  const budget = new DetailBudget();
  expect(budget.take(MOST, MOST)).toBe(false);
  expect(budget.reach).toBe(1);
});

test("detail comes nearer until the budget is kept, rests, and goes back when there is room", () => {
  const random = seededRandom(36);
  for (let run = 0; run < 200; run++) {
    const budget = new DetailBudget();
    const crowded = forestOf(random() * 0.9 * MOST, random() * 4 * MOST);
    expect(settle(budget, crowded)).toBeLessThan(40);
    expect(crowded(budget.reach) <= MOST || budget.reach === 0.25).toBe(true);
    settle(budget, forestOf(0, 0.7 * MOST));
    expect(budget.reach).toBe(1);
  }
});
