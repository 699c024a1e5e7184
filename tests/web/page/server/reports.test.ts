/** Reports of trees are fetched once for each state of a tree. */
import { expect, test, vi } from "vitest";
import { reportOf } from "../../../../web/src/page/server/reports";

const answers = vi.hoisted(() => ({ asked: [] as string[], fails: false }));
vi.mock("../../../../web/src/page/server/api", () => ({
  fetchTree: async (id: string) => {
    answers.asked.push(id);
    if (answers.fails) throw new Error("unreachable");
    return { id, report: { number: answers.asked.length } };
  },
}));

test("a report is fetched once, and again once its tree has changed", async () => {
  const ash = { id: "ash", updated_at: "2026-01-01T00:00:00Z" };
  expect(await Promise.all([reportOf(ash), reportOf(ash)])).toEqual([{ number: 1 }, { number: 1 }]);
  expect(await reportOf({ ...ash, updated_at: "2026-01-01T00:00:01Z" })).toEqual({ number: 2 });
  expect(answers.asked).toEqual(["ash", "ash"]);
});

test("a report that could not be fetched is asked for again", async () => {
  const oak = { id: "oak", updated_at: "2026-01-01T00:00:00Z" };
  answers.fails = true;
  expect(await reportOf(oak)).toBeNull();
  answers.fails = false;
  expect(await reportOf(oak)).toMatchObject({ number: expect.any(Number) });
});
