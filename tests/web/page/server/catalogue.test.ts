/** Loading of trees, meshes and tables, also out of order. */
import { afterEach, describe, expect, test, vi } from "vitest";
import type { Tree } from "../../../../web/src/page/server/api";
import { Catalogue } from "../../../../web/src/page/server/catalogue";
import { DEFAULTS, type Settings } from "../../../../web/src/page/settings/settings";
import { EDGE_VIEW } from "../../../../web/src/scene/camera/viewpoints";
import { firstInView } from "../../../../web/src/scene/forest";
import { watch } from "../../../../web/src/page/store/signals";
import { Store } from "../../../../web/src/page/store/store";
import type { TableMotion } from "../../../../web/player/src/worker/protocol";

const model = vi.hoisted(() => ({ parts: [{ vertices: 3 }] }));
const problems = vi.hoisted(() => [] as string[]);
vi.mock("../../../../web/src/page/ui/toast", () => ({ showToast: (title: string) => problems.push(title) }));
const handlers = vi.hoisted(() => ({ change: (_: unknown) => {} }));

vi.mock("../../../../web/src/page/server/api", () => ({
  fetchModel: async () => model,
  Problem: class extends Error {},
}));
vi.mock("../../../../web/src/page/server/eventStream", () => ({
  followEvents: (given: typeof handlers) => {
    handlers.change = given.change;
    return { retry() {}, close() {} };
  },
}));

const tree = (table: string | null): Tree =>
  ({ id: "elm", species: "elm", builtin: true, state: "ready", mesh_sha256: "m", table_sha256: table }) as Tree;
const recorded = (table: string, records: string | null): Tree => ({ ...tree(table), records_sha256: records });
const motionOf = (sha256: string, vertices = 3) =>
  ({ sha256, vertexNode: new Uint16Array(vertices) }) as unknown as TableMotion;

/** A catalogue whose tables are delivered by the test. `waiting`: for its first tree. */
function started(settings: Partial<Settings> = {}, waiting = false) {
  const store = new Store({ ...DEFAULTS, season: "summer", ...settings }, DEFAULTS, "");
  const arriving = new Map<string, { resolve(motion: TableMotion): void; reject(error: Error): void }>();
  const grown: (string | null)[] = [];
  const catalogue = new Catalogue(store, {
    loadTable: (sha256) => new Promise((resolve, reject) => arriving.set(sha256, { resolve, reject })),
  });
  watch(
    () => [catalogue.assetChanges.value],
    () => grown.push(catalogue.assets[0]?.motion?.sha256 ?? null),
  );
  const settle = async () => {
    // A mesh is read in a task of its own.
    for (let task = 0; task < 3; task++) await new Promise((done) => setTimeout(done));
  };
  if (!waiting) catalogue.order.loadAll();
  return { arriving, grown, settle, catalogue, settings: store.settings, state: store.state };
}

afterEach(() => {
  vi.clearAllMocks();
  problems.length = 0;
});

test("a tree is static until its table is loaded, and is placed only once if both are loading", async () => {
  const { arriving, grown, settle } = started();
  handlers.change({ tree: tree(null), job: null });
  await settle();
  handlers.change({ tree: tree("full"), job: null });
  arriving.get("full")?.resolve(motionOf("full"));
  await settle();
  expect(grown).toEqual([null, "full"]);
});

test("a full table replaces a preliminary one, even if that one arrives later", async () => {
  const { arriving, grown, settle, catalogue } = started();
  handlers.change({ tree: tree("early"), job: null });
  handlers.change({ tree: tree("full"), job: null });
  arriving.get("full")?.resolve(motionOf("full"));
  await settle();
  arriving.get("early")?.resolve(motionOf("early"));
  await settle();
  expect(grown.at(-1)).toBe("full");
  expect(catalogue.assets[0].motion?.sha256).toBe("full");
});

test("a failed load is reported for a current table but not for a superseded one", async () => {
  const { arriving, settle } = started();
  handlers.change({ tree: tree("early"), job: null });
  handlers.change({ tree: tree("full"), job: null });
  arriving.get("early")?.reject(new Error("404"));
  await settle();
  expect(problems).toEqual([]);
  arriving.get("full")?.reject(new Error("unreadable"));
  await settle();
  expect(problems).toHaveLength(1);
});

test("species outside the mix are loaded when they are wanted, by their share or by an inventory", async () => {
  const { arriving, settle, settings, state, catalogue } = started({ shares: { oak: 0, elm: 0 } });
  const oak = (id: string, form: "open" | "forest"): Tree => ({ ...tree(id), id, species: "oak", form });
  handlers.change({ tree: tree("full"), job: null });
  handlers.change({ tree: oak("oak-forest", "forest"), job: null });
  handlers.change({ tree: oak("oak", "open"), job: null });
  await settle();
  expect([...arriving.keys()]).toEqual([]);
  expect(catalogue.kinds.map(({ id }) => id)).toEqual(["elm", "oak"]);
  settings.shares = { elm: 0 };
  await settle();
  expect([...arriving.keys()].toSorted()).toEqual(["oak", "oak-forest"]);
  state.inventory = { builtin: new Set(["elm"]), names: new Set() } as unknown as typeof state.inventory;
  await settle();
  expect(catalogue.assets.map(({ id }) => id)).toEqual(["elm"]);
  expect(arriving.has("full")).toBe(true);
  state.inventory = { builtin: new Set(["oak", "palm"]), names: new Set() } as unknown as typeof state.inventory;
  await settle();
  expect(catalogue.assets.map(({ id }) => id)).toEqual(["elm", "oak-forest", "oak"]);
});

describe("the first tree", () => {
  const oak = { ...tree("oak"), id: "oak", species: "oak" };
  const three = [tree("elm"), oak, { ...tree("ash"), id: "ash", species: "ash" }];

  /** A catalogue that has chosen its first tree. */
  async function chosen(settings: Partial<Settings> = {}) {
    const all = started({ shares: {}, ...settings }, true);
    for (const one of three) handlers.change({ tree: one, job: null });
    await all.catalogue.order.firstLoads;
    await all.settle();
    return all;
  }

  test("stands in the middle of the first picture, and loads before the others", async () => {
    const { arriving, settle, state, catalogue, settings } = await chosen();
    expect(catalogue.order.awaitsFirst).toBe(true);
    const first = firstInView(catalogue.assets, settings.trees, settings.forestSeed, settings, EDGE_VIEW);
    expect([...arriving.keys()]).toEqual([first?.id]);
    state.treesSeen = true;
    await settle();
    expect(catalogue.order.awaitsFirst).toBe(false);
    expect([...arriving.keys()].toSorted()).toEqual(["ash", "elm", "oak"]);
  });

  test("that cannot be loaded does not hold up the others", async () => {
    const { arriving, settle } = await chosen({ shares: { ash: 0 } });
    arriving.values().next().value?.reject(new Error("404"));
    await settle();
    expect([...arriving.keys()].toSorted()).toEqual(["elm", "oak"]);
  });

  test("is not waited for by an inventory or where a link shares the forest", async () => {
    const { arriving, settle, state } = await chosen();
    state.inventory = "loading";
    await settle();
    expect(arriving.size).toBe(3);
    expect(new Catalogue(new Store(DEFAULTS, DEFAULTS, "?share=f00d"), { loadTable: vi.fn() }).order.awaitsFirst).toBe(false);
  });
});

test("a table of another mesh is not used", async () => {
  const { arriving, settle, catalogue } = started();
  handlers.change({ tree: tree("other"), job: null });
  arriving.get("other")?.resolve(motionOf("other", 7));
  await settle();
  expect(catalogue.assets[0].motion).toBeNull();
});

test("new records of a tree are announced once, with the state of its job", async () => {
  const { settle, catalogue } = started();
  handlers.change({ tree: tree("full"), job: { state: "running", stage: "records", fraction: 0.4 } });
  handlers.change({ tree: recorded("full", null), job: null });
  await settle();
  expect(catalogue.recordChanges.value).toBe(0);
  handlers.change({ tree: recorded("full", "r"), job: null });
  handlers.change({ tree: recorded("full", "r"), job: null });
  expect(catalogue.recordChanges.value).toBe(1);
  expect(catalogue.find("elm")).toMatchObject({ job: null, tree: { records_sha256: "r" } });
  expect(catalogue.find("yew")).toBeNull();
});

describe("tables without leaves", () => {
  const both = (table: string, bare: string | null): Tree => ({ ...tree(table), bare_table_sha256: bare });

  test("are loaded when winter comes, once, and the trees move by the other until then", async () => {
    const { arriving, grown, settle, catalogue, settings } = started();
    handlers.change({ tree: both("leaf", "bare"), job: null });
    arriving.get("leaf")?.resolve(motionOf("leaf"));
    await settle();
    expect([...arriving.keys()]).toEqual(["leaf"]);
    settings.season = "winter";
    await settle();
    expect(grown).toEqual(["leaf"]);
    arriving.get("bare")?.resolve(motionOf("bare"));
    await settle();
    settings.season = "summer";
    arriving.clear();
    settings.season = "winter";
    expect(grown).toEqual(["leaf", "bare", "leaf", "bare"]);
    expect(arriving.size).toBe(0);
    expect(catalogue.leafMotion("elm")?.sha256).toBe("leaf");
    expect(catalogue.find("elm")?.motion?.sha256).toBe("bare");
  });

  test("a tree without one keeps its table in winter", async () => {
    const { arriving, grown, settle, settings } = started();
    handlers.change({ tree: both("leaf", null), job: null });
    arriving.get("leaf")?.resolve(motionOf("leaf"));
    await settle();
    settings.season = "winter";
    await settle();
    expect(grown).toEqual(["leaf"]);
    expect([...arriving.keys()]).toEqual(["leaf"]);
  });

  test("one that is computed in winter is taken up, and one that is gone is given up", async () => {
    const { arriving, settle, catalogue, settings } = started();
    settings.season = "winter";
    handlers.change({ tree: both("leaf", null), job: null });
    arriving.get("leaf")?.resolve(motionOf("leaf"));
    await settle();
    handlers.change({ tree: both("leaf", "bare"), job: null });
    arriving.get("bare")?.resolve(motionOf("bare"));
    await settle();
    expect(catalogue.assets[0].motion?.sha256).toBe("bare");
    handlers.change({ tree: both("leaf", null), job: null });
    expect(catalogue.assets[0].motion?.sha256).toBe("leaf");
  });

  test("one that cannot be loaded is reported, and tried again next winter", async () => {
    const { arriving, settle, catalogue, settings } = started();
    handlers.change({ tree: both("leaf", "bare"), job: null });
    arriving.get("leaf")?.resolve(motionOf("leaf"));
    settings.season = "winter";
    arriving.get("bare")?.reject(new Error("unreadable"));
    await settle();
    expect(problems).toHaveLength(1);
    expect(catalogue.assets[0].motion?.sha256).toBe("leaf");
    settings.season = "summer";
    settings.season = "winter";
    arriving.get("bare")?.resolve(motionOf("bare"));
    await settle();
    expect(catalogue.assets[0].motion?.sha256).toBe("bare");
  });

  test("one of another mesh is not used", async () => {
    const { arriving, settle, catalogue, settings } = started();
    handlers.change({ tree: both("leaf", "bare"), job: null });
    arriving.get("leaf")?.resolve({ ...motionOf("leaf"), meshSha256: "m" });
    settings.season = "winter";
    arriving.get("bare")?.resolve({ ...motionOf("bare"), meshSha256: "another" });
    await settle();
    expect(catalogue.assets[0].motion?.sha256).toBe("leaf");
  });
});

test("the forms of a built-in species are one kind, each upload is its own", () => {
  const { catalogue } = started();
  const builtin = (id: string, form: "open" | "forest") => ({ ...tree(null), id, name: id, builtin: true, form });
  const uploaded = { ...tree(null), id: "mine", name: "my elm", builtin: false, form: "open" as const };
  for (const one of [builtin("elm-forest", "forest"), builtin("elm", "open"), uploaded])
    handlers.change({ tree: one, job: null });
  expect(catalogue.kinds).toEqual([{ id: "elm", name: "Elm" }]);
  expect(catalogue.uploads).toEqual([{ id: "mine", name: "My elm" }]);
});

test("an upload is loaded once it is planted, and leaves the forest when it no longer is", async () => {
  const { arriving, grown, settle, catalogue, settings } = started();
  handlers.change({ tree: { ...tree("full"), id: "yours", builtin: false }, job: null });
  await settle();
  expect([arriving.size, catalogue.assets, catalogue.known, grown]).toEqual([0, [], [], []]);
  expect(catalogue.uploads).toHaveLength(1);
  settings.planted = { yours: "one" };
  arriving.get("full")?.resolve(motionOf("full"));
  await settle();
  expect(grown).toEqual(["full"]);
  settings.planted = {};
  expect(catalogue.assets).toEqual([]);
});

test("an upload with the name of a species in the inventory is loaded", async () => {
  const { arriving, catalogue, state, settle } = started();
  handlers.change({ tree: { ...tree("full"), id: "yours", name: "Sorb", builtin: false }, job: null });
  state.inventory = { names: new Set(["sorb"]) } as never;
  await settle();
  expect([...arriving.keys()]).toEqual(["full"]);
  state.inventory = "loading";
  expect(catalogue.assets).toEqual([]);
});

test("in a shared forest that the server moves, trees keep their leaves' tables in winter", async () => {
  const { arriving, catalogue, settings, state, settle } = started({ season: "winter", lookup: "server" });
  handlers.change({ tree: { ...tree("leaf"), bare_table_sha256: "bare" }, job: null });
  arriving.get("leaf")?.resolve(motionOf("leaf"));
  await settle();
  arriving.get("bare")?.resolve(motionOf("bare"));
  await settle();
  expect(catalogue.assets[0].motion?.sha256).toBe("bare");
  state.share = "meadow";
  expect(catalogue.assets[0].motion?.sha256).toBe("leaf");
  settings.lookup = "worker";
  expect(catalogue.assets[0].motion?.sha256).toBe("bare");
});

test("the other form stands in for one that cannot be loaded", async () => {
  const { arriving, settle, catalogue } = started();
  handlers.change({ tree: tree("full"), job: null });
  expect(catalogue.assets[0].hasTable).toBe(true);
  expect(catalogue.isLoaded).toBe(false);
  arriving.get("full")?.reject(new Error("unreadable"));
  await settle();
  expect(problems).toHaveLength(1);
  expect(catalogue.assets[0].hasTable).toBe(false);
  expect(catalogue.isLoaded).toBe(true);
});

test("who listens late hears the last change of each tree that still exists", () => {
  const { catalogue } = started();
  handlers.change({ tree: tree(null), job: null });
  handlers.change({ tree: tree("full"), job: null });
  handlers.change({ tree: { ...tree(null), id: "yew" }, job: null });
  handlers.change({ tree: { ...tree(null), id: "yew" }, job: null, deleted: true });
  const heard: (string | null | undefined)[] = [];
  catalogue.onChange((change) => heard.push(change.tree.table_sha256));
  expect(heard).toEqual(["full"]);
});
