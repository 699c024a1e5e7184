/** Growing trees for the stems of an inventory: what is asked for, waited for, planted and ended. */
import { beforeEach, expect, test, vi } from "vitest";
import type { OwnTreesState, OwnTreesTools } from "../../../web/src/page/inventory/ownTreesCard";
import { OwnTreesOfStems } from "../../../web/src/page/inventory/ownTreesOfStems";
import type { NamedInventory } from "../../../web/src/page/inventory/namedInventory";
import { type Job, Problem, type Tree, type TreeChange } from "../../../web/src/page/server/api";
import { DEFAULTS } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";

const page = vi.hoisted(() => ({
  tools: null as unknown,
  shown: [] as unknown[],
  root: { hidden: false },
  toasts: [] as string[],
  orders: [] as { height_m: number }[],
  cancelled: [] as string[],
  deleted: [] as string[],
  answer: null as ((order: { height_m: number }) => Promise<unknown>) | null,
}));
vi.mock("../../../web/src/page/ui/toast", () => ({
  showToast: (title: string, hint: string) => page.toasts.push(`${title} ${hint}`),
}));
vi.mock("../../../web/src/page/inventory/ownTreesCard", () => ({
  OwnTreesCard: class {
    readonly root = page.root;
    constructor(tools: unknown) {
      page.tools = tools;
    }
    show(state: unknown): void {
      page.shown.push(state);
    }
  },
}));
vi.mock("../../../web/src/page/server/api", async (original) => ({
  ...(await original<object>()),
  growIndividual: (order: { height_m: number }) => {
    page.orders.push(order);
    return page.answer?.(order);
  },
  cancelJob: async (id: string) => void page.cancelled.push(id),
  deleteTree: async (id: string) => void page.deleted.push(id),
}));

const HEIGHTS_M = [10, 14, 18];
const INVENTORY = {
  name: "stand.csv",
  stems: HEIGHTS_M.map((height_m) => ({
    east_m: 0, north_m: 0, species: "", builtin: "oak", height_m, slender: false,
  })),
} as unknown as NamedInventory;
const settle = () => new Promise((done) => setTimeout(done));
const last = () => page.shown.at(-1) as OwnTreesState;
const tools = () => page.tools as OwnTreesTools;

const idOf = (height_m: number) => `oak-${height_m}`;
function change(height_m: number, state: Tree["state"], job: Partial<Job>, deleted = false): TreeChange {
  const id = idOf(height_m);
  return { tree: { id, grown: true, state } as Tree, job: { id: `job-${id}`, ...job } as Job, deleted };
}
const ready = (height_m: number) => change(height_m, "ready", { state: "done" });

beforeEach(() => {
  for (const list of [page.shown, page.toasts, page.orders, page.cancelled, page.deleted]) list.length = 0;
  page.root.hidden = false;
  page.answer = async ({ height_m }) => ({ id: idOf(height_m), job_id: `job-${idOf(height_m)}` });
});

function started() {
  const { state } = new Store({ ...DEFAULTS }, DEFAULTS, "");
  const store = { state, settings: { ...DEFAULTS } } as unknown as Store;
  let hear: (change: TreeChange) => void = () => {};
  const catalogue = { onChange: (listener: typeof hear) => (hear = listener) };
  new OwnTreesOfStems(store, catalogue as never, { append: () => {} } as never);
  state.inventory = INVENTORY;
  return { state, hear: (one: TreeChange) => hear(one) };
}

test("trees are asked for, and planted together once the last one is there", async () => {
  const { state, hear } = started();
  expect(last()).toEqual({ at: "offer", stems: 3 });
  hear(ready(10)); // grown for somebody else
  tools().grow(3);
  await settle();
  expect(page.orders.map(({ height_m }) => height_m)).toEqual(HEIGHTS_M);
  expect(page.orders[0]).toMatchObject({ species: "oak", form: "open", nearest_size: true });
  expect(last()).toEqual({ at: "growing", done: 1, all: 3 });
  hear(change(18, "building", { state: "running" }));
  hear(ready(18));
  expect([last(), state.individuals]).toEqual([{ at: "growing", done: 2, all: 3 }, []]);
  hear(ready(14));
  expect(state.individuals.map(({ id }) => id).sort()).toEqual(HEIGHTS_M.map(idOf));
  expect(last()).toEqual({ at: "planted", trees: 3, shown: 3, stems: 3 });
  tools().leave();
  expect([state.individuals, last()]).toEqual([[], { at: "offer", stems: 3 }]);
});

test("what fails is said, once, and an earlier failure of the same tree does not count", async () => {
  const { state, hear } = started();
  hear(change(14, "failed", { id: "an earlier job", state: "failed", error: "Node was missing." }));
  tools().grow(3);
  await settle();
  expect(last()).toEqual({ at: "growing", done: 0, all: 3 });
  hear(change(14, "building", { state: "queued" }));
  for (const height_m of [10, 14]) hear(ready(height_m));
  hear(change(18, "failed", { state: "failed", error: "The disk is full." }));
  expect(state.individuals).toHaveLength(2);
  expect(page.toasts).toEqual(["1 of 3 trees could not be grown. The disk is full."]);
});

test("cancelling ends what is not there yet, and removes it once it has ended", async () => {
  const { state, hear } = started();
  tools().grow(3);
  await settle();
  hear(ready(10));
  hear(change(14, "building", { state: "running" }));
  tools().cancel();
  expect(page.cancelled).toEqual([`job-${idOf(14)}`]);
  hear(change(18, "building", { state: "queued" }));
  expect(page.cancelled).toEqual([`job-${idOf(14)}`, `job-${idOf(18)}`]);
  for (const height_m of [14, 18]) hear(change(height_m, "uploaded", { state: "cancelled" }));
  expect([page.deleted, state.individuals]).toEqual([[idOf(14), idOf(18)], []]);
  hear(change(14, "uploaded", { state: "cancelled" }, true));
  expect(page.deleted).toHaveLength(2);
});

test("another inventory ends it, and a refusal leaves the offer", async () => {
  const { state, hear } = started();
  tools().grow(3);
  await settle();
  hear(change(10, "building", { state: "running" }));
  state.inventory = null;
  expect([page.root.hidden, page.cancelled]).toEqual([true, [`job-${idOf(10)}`]]);
  state.inventory = INVENTORY;
  page.answer = async () => {
    throw new Problem("The storage quota is reached", "Delete trees.");
  };
  tools().grow(2);
  await settle();
  expect([last(), page.toasts]).toEqual([{ at: "offer", stems: 3 }, ["The storage quota is reached Delete trees."]]);
});

test("without a server, or in a shared forest, nothing is offered", () => {
  const { state } = started();
  expect(page.root.hidden).toBe(false);
  state.connected = false;
  expect(page.root.hidden).toBe(true);
  state.connected = true;
  state.share = "abc";
  expect(page.root.hidden).toBe(true);
});
