/** The forest's own trees: what is found and asked for, waited for, planted and ended. */
import { beforeEach, describe, expect, test, vi } from "vitest";
import { Individuals, type Trees } from "../../../web/src/page/individuals/individuals";
import { growthWords } from "../../../web/src/page/individuals/growthView";
import type { NamedInventory } from "../../../web/src/page/inventory/namedInventory";
import { Disconnected, type Job, Problem, type Tree, type TreeChange } from "../../../web/src/page/server/api";
import { DEFAULTS, type Settings } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";
import { treesOfForest, type BuiltinTree } from "../../../web/src/scene/forestIndividuals";
import type { Order } from "../../../web/src/scene/individuals";

type Answer = (order: Order) => Promise<{ id: string; job_id: string }>;

const page = vi.hoisted(() => ({
  toasts: [] as string[],
  /** What was asked for, and whether the visitor might have been asked for a key. */
  orders: [] as { height_m: number; seed: number; species: string }[],
  asks: [] as boolean[],
  cancelled: [] as string[],
  deleted: [] as string[],
  /** Ids of the trees that the server has. */
  there: new Set<string>(),
  cannotGrow: null as string | null,
  searched: 0,
  answer: null as unknown,
  fault: null as Error | null,
}));
vi.mock("../../../web/src/page/ui/toast", () => ({
  showToast: (title: string, hint: string) => page.toasts.push(`${title} ${hint}`),
}));
vi.mock("../../../web/src/page/server/api", async (original) => ({
  ...(await original<object>()),
  growIndividual: (order: Order, asks: boolean) => {
    page.orders.push(order);
    page.asks.push(asks);
    return (page.answer as Answer)(order);
  },
  findIndividuals: async (orders: Order[]) => {
    page.searched++;
    if (page.fault) throw page.fault;
    const trees = orders.map((order) => (page.there.has(idOf(order)) ? { id: idOf(order) } : null));
    return { trees, cannot_grow: page.cannotGrow };
  },
  cancelJob: async (id: string) => void page.cancelled.push(id),
  deleteTree: async (id: string) => void page.deleted.push(id),
}));

const idOf = ({ species, height_m, seed }: Pick<Order, "species" | "height_m" | "seed">) => `${species}-${seed}-${height_m}`;
const HEIGHTS_M = [10, 14, 18];
const oak = (height_m: number) => ({ species: "oak", height_m, seed: 1 + HEIGHTS_M.indexOf(height_m) });
const INVENTORY = {
  name: "stand.csv",
  stems: HEIGHTS_M.map((height_m) => ({
    east_m: 0, north_m: 0, species: "", builtin: "oak", height_m, slender: false,
  })),
} as unknown as NamedInventory;
const BUILTIN: BuiltinTree[] = ["oak", "birch"].map((species) => ({
  id: species, species, builtin: true, form: "open", height_m: 15,
}));
const settle = () => new Promise((done) => setTimeout(done));

function change(id: string, state: Tree["state"], job: Partial<Job>, deleted = false): TreeChange {
  return { tree: { id, grown: true, state } as Tree, job: { id: `job-${id}`, ...job } as Job, deleted };
}
const ready = (id: string) => change(id, "ready", { state: "done" });
const building = (id: string) => change(id, "building", { state: "running" });

beforeEach(() => {
  for (const list of [page.toasts, page.orders, page.asks, page.cancelled, page.deleted]) list.length = 0;
  page.there.clear();
  page.cannotGrow = null;
  page.fault = null;
  page.searched = 0;
  page.answer = (async (order) => ({ id: idOf(order), job_id: `job-${idOf(order)}` })) satisfies Answer;
});

function started(values: Partial<Settings> = {}, inventory: NamedInventory | null = INVENTORY) {
  const store = new Store({ ...DEFAULTS, trees: 40, shares: {}, ...values }, DEFAULTS, "");
  const { state, settings } = store;
  let hear: (change: TreeChange) => void = () => {};
  const catalogue: Trees = {
    onChange: (listener) => (hear = listener),
    builtinTrees: BUILTIN,
    assetChanges: { value: 0 } as Trees["assetChanges"],
    isLoaded: true,
  };
  state.inventory = inventory;
  state.treesSeen = true;
  const { tools } = new Individuals(store, catalogue);
  return { store, state, settings, tools, hear: (one: TreeChange) => hear(one) };
}
const ids = (state: Store["state"]) => state.individuals.map(({ id }) => id);

describe("for the stems of an inventory", () => {
  test("trees are asked for, and planted together once the last one is there", async () => {
    const { state, settings, tools, hear } = started();
    expect([state.growth, page.searched]).toEqual([{ at: "none" }, 0]);
    hear(ready(idOf(oak(10)))); // grown for somebody else, after the page has looked
    tools.grow(3);
    await settle();
    expect(settings.ownTrees).toBe(3);
    expect(page.orders.map(({ height_m }) => height_m)).toEqual(HEIGHTS_M);
    expect(page.orders[0]).toMatchObject({ species: "oak", form: "open", dbh_cm: null });
    expect(state.growth).toEqual({ at: "growing", done: 1, all: 3 });
    hear(building(idOf(oak(18))));
    hear(ready(idOf(oak(18))));
    expect([state.growth, state.individuals]).toEqual([{ at: "growing", done: 2, all: 3 }, []]);
    hear(ready(idOf(oak(14))));
    expect(ids(state)).toEqual(HEIGHTS_M.map((height_m) => idOf(oak(height_m))));
    expect(state.growth).toEqual({ at: "planted", trees: 3, shown: 3, all: 3 });
    tools.leave();
    expect([state.individuals, state.growth, settings.ownTrees]).toEqual([[], { at: "none" }, 0]);
  });

  test("what fails is said, once, and an earlier failure of the same tree does not count", async () => {
    const { state, tools, hear } = started();
    hear(change(idOf(oak(14)), "failed", { id: "an earlier job", state: "failed", error: "Node was missing." }));
    tools.grow(3);
    await settle();
    expect(state.growth).toEqual({ at: "growing", done: 0, all: 3 });
    hear(change(idOf(oak(14)), "building", { state: "queued" }));
    for (const height_m of [10, 14]) hear(ready(idOf(oak(height_m))));
    hear(change(idOf(oak(18)), "failed", { state: "failed", error: "The disk is full." }));
    expect(state.individuals).toHaveLength(2);
    expect(page.toasts).toEqual(["1 of 3 trees could not be grown. The disk is full."]);
  });

  test("cancelling ends what is not there yet, and removes it once it has ended", async () => {
    const { state, settings, tools, hear } = started();
    tools.grow(3);
    await settle();
    hear(ready(idOf(oak(10))));
    hear(building(idOf(oak(14))));
    tools.cancel();
    hear(building(idOf(oak(14)))); // the request is on its way
    expect(page.cancelled).toEqual([`job-${idOf(oak(14))}`]);
    hear(change(idOf(oak(18)), "building", { state: "queued" }));
    expect(page.cancelled).toEqual([14, 18].map((height_m) => `job-${idOf(oak(height_m))}`));
    for (const height_m of [14, 18]) hear(change(idOf(oak(height_m)), "uploaded", { state: "cancelled" }));
    expect(page.deleted).toEqual([14, 18].map((height_m) => idOf(oak(height_m))));
    hear(change(idOf(oak(14)), "uploaded", { state: "cancelled" }, true));
    expect(page.deleted).toHaveLength(2);
    expect([state.individuals, state.growth, settings.ownTrees]).toEqual([[], { at: "none" }, 0]);
  });

  test("trees that are wanted again while they are being removed are asked for again", async () => {
    const { state, tools, hear } = started();
    tools.grow(3);
    await settle();
    const id = idOf(oak(14));
    hear(building(id));
    tools.cancel();
    hear(change(id, "uploaded", { state: "cancelled" }));
    expect(page.deleted).toEqual([id]); // on its way
    page.orders.length = 0;
    page.answer = (async (order) => ({ id: idOf(order), job_id: `again-${idOf(order)}` })) satisfies Answer;
    tools.grow(3);
    await settle();
    expect(page.orders.map(({ height_m }) => height_m)).toEqual(HEIGHTS_M);
    hear(change(id, "uploaded", { state: "cancelled" }, true));
    await settle();
    expect(page.orders.map(({ height_m }) => height_m)).toEqual([...HEIGHTS_M, 14]);
    hear(change(id, "uploaded", { id: `again-${id}`, state: "failed", error: "The disk is full." }));
    for (const height_m of [10, 18]) hear(ready(idOf(oak(height_m))));
    expect(state.growth, "what fails by itself is not asked for again").toEqual({ at: "planted", trees: 2, shown: 3, all: 3 });
    expect(page.toasts).toEqual(["1 of 3 trees could not be grown. The disk is full."]);
  });

  test("a tree that is removed before the answer to a request names it is asked for again", async () => {
    const { state, tools, hear } = started();
    const id = idOf(oak(14));
    let answered = 0;
    page.answer = (async (order) => {
      if (idOf(order) === id && ++answered === 1) hear(change(id, "uploaded", { state: "cancelled" }, true));
      return { id: idOf(order), job_id: `job-${idOf(order)}-${answered}` };
    }) satisfies Answer;
    tools.grow(3);
    await settle();
    expect(page.orders.map(({ height_m }) => height_m)).toEqual([10, 14, 14, 18]);
    for (const height_m of HEIGHTS_M) hear(ready(idOf(oak(height_m))));
    expect(state.growth).toEqual({ at: "planted", trees: 3, shown: 3, all: 3 });
  });

  test("another inventory ends it, and has its own", async () => {
    const { state, settings, tools, hear } = started();
    tools.grow(3);
    await settle();
    hear(building(idOf(oak(10))));
    state.inventory = "loading";
    expect(page.cancelled).toEqual([`job-${idOf(oak(10))}`]);
    page.orders.length = 0;
    state.inventory = { ...INVENTORY, stems: INVENTORY.stems.slice(1) };
    await settle();
    expect(page.orders.map(({ height_m }) => height_m)).toEqual([14, 18]);
    settings.ownTrees = 0;
    expect([state.growth, state.individuals]).toEqual([{ at: "none" }, []]);
  });

  test("a refusal is shown, plants what is there, and is tried again", async () => {
    page.there.add(idOf(oak(10)));
    page.answer = async () => {
      throw new Problem("The storage quota is reached", "Delete trees.");
    };
    const { state, tools } = started();
    tools.grow(3);
    await settle();
    expect(ids(state)).toEqual([idOf(oak(10))]);
    expect(state.growth).toEqual({
      at: "refused", title: "The storage quota is reached", hint: "Delete trees.", final: false,
    });
    for (const height_m of HEIGHTS_M) page.there.add(idOf(oak(height_m)));
    tools.again();
    await settle();
    expect(state.growth).toEqual({ at: "planted", trees: 3, shown: 3, all: 3 });
    expect(page.toasts).toEqual([]);
  });
});

describe("for the generated forest", () => {
  const orders = (number: number, settings: Settings) => treesOfForest(BUILTIN, settings, number);

  test("a link finds the trees that are there, and asks for none of them and for no key", async () => {
    const settings = { ...DEFAULTS, trees: 40, shares: {}, ownTrees: 6 };
    for (const order of orders(6, settings)) page.there.add(idOf(order));
    const { state } = started(settings, null);
    expect(state.growth.at).toBe("growing"); // from the start: a shared forest waits
    await settle();
    expect(ids(state)).toEqual(orders(6, settings).map(idOf));
    expect([page.orders, state.growth]).toEqual([[], { at: "planted", trees: 6, shown: 40, all: 40 }]);
    page.there.clear();
    started(settings, null);
    await settle();
    expect(page.asks).toEqual(Array(6).fill(false));
  });

  test("one that the visitor has chosen may ask for a key, one that others have not", async () => {
    const { settings, store } = started({}, null);
    settings.ownTrees = 1;
    await settle();
    store.adopt({ ownTrees: 2 });
    await settle();
    expect(page.asks).toEqual([true, false]);
  });

  test("a larger number asks for the others only, and cancelling it keeps the planted ones", async () => {
    const { state, settings, hear, tools } = started({}, null);
    settings.ownTrees = 2;
    await settle();
    const first = orders(2, settings).map(idOf);
    for (const id of first) {
      hear(ready(id));
      page.there.add(id);
    }
    expect(ids(state)).toEqual(first);
    settings.ownTrees = 5;
    await settle();
    expect(page.orders).toHaveLength(5);
    expect([ids(state), state.growth]).toEqual([first, { at: "growing", done: 2, all: 5 }]);
    const kept = state.individuals;
    tools.cancel();
    await settle();
    expect([settings.ownTrees, state.individuals]).toEqual([2, kept]);
    expect(state.growth).toEqual({ at: "planted", trees: 2, shown: 40, all: 40 });
  });

  test("what grows already goes on when the number changes meanwhile", async () => {
    const { state, settings, hear } = started({}, null);
    settings.ownTrees = 3;
    await settle();
    const asked = page.orders.map(idOf);
    for (const id of asked) hear(building(id));
    settings.ownTrees = 2;
    await settle();
    const wanted = orders(2, settings).map(idOf);
    expect(page.orders).toHaveLength(3);
    expect(page.cancelled).toEqual(asked.filter((id) => !wanted.includes(id)).map((id) => `job-${id}`));
    for (const id of wanted) hear(ready(id));
    expect(ids(state)).toEqual(wanted);
  });

  test("more trees in the forest need few others; another seed needs all", async () => {
    const { state, settings, tools } = started({}, null);
    settings.ownTrees = 8;
    await settle();
    const before = new Set(page.orders.map(idOf));
    settings.trees = 60;
    await settle();
    expect(orders(8, settings).filter((order) => !before.has(idOf(order))).length).toBeLessThan(3);
    for (const order of orders(8, settings)) page.there.add(idOf(order));
    tools.again();
    await settle();
    const kept = state.individuals;
    expect(state.growth).toMatchObject({ at: "planted", trees: 8, shown: 60, all: 60 });
    settings.trees = 61; // the same trees stand for one more
    await settle();
    expect(state.individuals).toBe(kept);
    expect(state.growth).toMatchObject({ at: "planted", trees: 8, shown: 61, all: 61 });
    settings.forestSeed = 8;
    await settle();
    expect(orders(8, settings).some((order) => before.has(idOf(order)))).toBe(false);
  });

  test("nothing is asked for before the forest is seen, nor where only an upload stands", async () => {
    const { state, store } = started({ ownTrees: 2 }, "loading" as never);
    await settle();
    expect([page.searched, state.growth.at]).toEqual([0, "growing"]);
    store.change({ planted: { mine: "only" } });
    state.inventory = null;
    await settle();
    expect([page.searched, state.growth]).toEqual([0, { at: "none" }]);
  });

  test("a server that grows no trees, or none at all, says why", async () => {
    page.cannotGrow = "Install Node 20.";
    const { state, settings, tools } = started({}, null);
    settings.ownTrees = 2;
    await settle();
    expect(state.growth).toEqual({
      at: "refused", title: "This server cannot grow trees.", hint: "Install Node 20.", final: true,
    });
    expect(page.orders).toEqual([]);
    page.fault = new Disconnected();
    tools.again();
    await settle();
    expect(state.growth).toMatchObject({ title: "The server is not connected.", final: false });
    expect(growthWords(state.growth, "trees")).toMatch(/^The server is not connected\. \w.+\. The built-in trees stand/);
    page.fault = page.cannotGrow = null;
    for (const order of orders(2, settings)) page.there.add(idOf(order));
    tools.again();
    await settle();
    expect(growthWords(state.growth, "trees")).toBe("2 trees of their own stand for 40 of 40 trees.");
  });
});
