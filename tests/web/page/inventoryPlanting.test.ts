/** The inventory of the page, from an address and from a file. */
import { afterEach, expect, test, vi } from "vitest";
import type { InventoryTools } from "../../../web/src/page/inventory/inventoryCard";
import { canBeShared, InventoryPlanting } from "../../../web/src/page/inventory/inventoryPlanting";
import type { NamedInventory } from "../../../web/src/page/inventory/namedInventory";
import { Problem } from "../../../web/src/page/server/api";
import { DEFAULTS, type Settings } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";

const page = vi.hoisted(() => ({
  tools: null as unknown,
  toasts: [] as string[],
  asked: new Map<string, { resolve(inventory: unknown): void; reject(error: Error): void }>(),
}));
vi.mock("../../../web/src/page/ui/toast", () => ({ showToast: (title: string) => page.toasts.push(title) }));
vi.mock("../../../web/src/page/inventory/inventoryCard", () => ({
  makeInventoryCard: (_: unknown, tools: unknown) => {
    page.tools = tools;
  },
}));
vi.mock("../../../web/src/page/inventory/namedInventory", () => ({
  loadInventory: (address: string) =>
    new Promise((resolve, reject) => page.asked.set(address, { resolve, reject })),
  namedInventory: (inventory: object, name: string) => ({ ...inventory, name }),
  showInventory: () => {},
}));
afterEach(() => {
  page.asked.clear();
  page.toasts.length = 0;
});

const named = (name: string) => ({ stems: [], name }) as unknown as NamedInventory;
const MINE = new File([""], "mine.csv");
const settle = () => new Promise((done) => setTimeout(done));

function started(settings: Partial<Settings> = {}, query = "") {
  const store = new Store({ ...DEFAULTS, ...settings }, DEFAULTS, query);
  const world = { look: vi.fn(), stage: { camera: { aspect: 1.5 } } };
  const planting = new InventoryPlanting(store, world as never);
  return { store, settings: store.settings, state: store.state, world, planting };
}

test("the inventory of the address is loaded, and shown unless the link has a view", async () => {
  for (const [query, looks] of [["", 1], ["?view=1,2,3,4,5,6", 0]] as const) {
    const { state, world } = started({ inventory: "api/a" }, query);
    expect(state.inventory).toBe("loading");
    page.asked.get("api/a")?.resolve(named("a"));
    await settle();
    expect([state.inventory, world.look.mock.calls.length]).toEqual([named("a"), looks]);
  }
});

test("of two addresses the last one counts, whichever answers first", async () => {
  const { settings, state } = started({ inventory: "api/a" });
  settings.inventory = "api/b";
  page.asked.get("api/b")?.resolve(named("b"));
  page.asked.get("api/a")?.resolve(named("a"));
  await settle();
  expect(state.inventory).toEqual(named("b"));
});

test("one that cannot be loaded leaves the usual forest, and says why", async () => {
  const { state } = started({ inventory: "api/a" });
  page.asked.get("api/a")?.reject(new Problem("Gone.", "Ask for another one."));
  await settle();
  expect([state.inventory, page.toasts]).toEqual([null, ["Gone."]]);
});

test("a failure of the page itself leaves the usual forest, too", async () => {
  const broken = new TypeError("a chunk is missing");
  const unhandled = new Promise((found) => process.once("unhandledRejection", found));
  const { state } = started({ inventory: "api/a" });
  page.asked.get("api/a")?.reject(broken);
  expect(await unhandled).toBe(broken);
  expect(state.inventory).toBeNull();
});

test("after a link with a view, another inventory is shown", async () => {
  const { world, planting } = started({ inventory: "api/a" }, "?view=1,2,3,4,5,6");
  page.asked.get("api/a")?.resolve(named("a"));
  await settle();
  planting.open({ stems: [] } as never, MINE);
  expect(world.look).toHaveBeenCalledOnce();
});

test("a file replaces the address, cannot be shared, and can be removed", async () => {
  const { store, settings, state, planting } = started({ inventory: "api/a" });
  page.asked.get("api/a")?.resolve(named("a"));
  await settle();
  expect(canBeShared(store)).toBe(true);
  planting.open({ stems: [] } as never, MINE);
  expect([settings.inventory, state.inventory]).toEqual(["", named("mine.csv")]);
  expect(canBeShared(store)).toBe(false);
  (page.tools as InventoryTools).remove();
  expect([state.inventory, canBeShared(store)]).toEqual([null, true]);
});

test("a shared forest is not planted from a file", () => {
  const { state, planting } = started({}, "?share=meadow");
  planting.open({ stems: [] } as never, MINE);
  expect([state.inventory, page.toasts]).toEqual([null, ["A shared forest cannot be planted from a file."]]);
});
