import { signal } from "@preact/signals-core";
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { OwnUploads } from "../../../../web/src/page/uploads/ownUploads";
import { RemainingTime } from "../../../../web/src/page/progress/remainingTime";
import { sendingWords } from "../../../../web/src/page/uploads/sendingDialog";
import { Planting, plantForest } from "../../../../web/src/page/forest/planting";
import { plantAs, plantedAs, plantedFrom, textOfPlanted } from "../../../../web/src/page/settings/planted";
import { DEFAULTS, queryFromSettings, type Settings, settingsFromQuery } from "../../../../web/src/page/settings/settings";
import { foreignPlacement, placementOf } from "../../../../web/src/page/settings/sharedForest";
import { Store } from "../../../../web/src/page/store/store";
import { faultOf } from "../../../../web/src/page/progress/progressCards";
import { timeLeft } from "../../../../web/src/page/ui/words";
import { treeView } from "../../../../web/src/scene/camera/treeView";
import { clearingPlace } from "../../../../web/src/scene/clearing";
import type { TreeAsset } from "../../../../web/src/scene/forest";
import { glade } from "../../../../web/src/scene/ground/landscape";
import { placeTrees } from "../../../../web/src/scene/placement";
import type { TreeModel } from "../../../../web/player/src/trees/mesh/treeMesh";
import { random } from "../../golden";

vi.mock("../../../../web/player/src/trees/mesh/treeMesh", () => ({ disposeModel: () => {} }));
vi.mock("../../../../web/src/page/ownTree/ownTree.css", () => ({}));

const MODEL = { parts: [], height_m: 8, radius_m: 3 } as unknown as TreeModel;
const asset = (id: string, builtin: boolean, model: TreeModel | null = MODEL): TreeAsset =>
  ({ id, species: id, builtin, form: "open", hasTable: true, model, motion: null });
const ASSETS = [asset("ash", true), asset("elm", true), asset("mine", false), asset("yours", false)];
const counts = (settings: Settings, assets = ASSETS) =>
  Object.fromEntries(plantForest(assets, settings).map((group) => [group.asset.id, group.instances.count]));
const settingsWith = (planted: Settings["planted"]): Settings => ({ ...DEFAULTS, trees: 200, shares: {}, planted });

describe("uploads in the forest", () => {
  test("take no place of the other trees unless they are planted among them", () => {
    const without = counts(settingsWith({}));
    expect(Object.keys(without)).toEqual(["ash", "elm"]);
    expect(counts(settingsWith({ mine: "one" }))).toEqual({ ...without, mine: 1 });
    const more = counts(settingsWith({ mine: "more" }));
    expect(more.mine).toBeGreaterThan(20);
    expect(more.ash + more.elm + more.mine).toBe(201);
    expect(counts(settingsWith({ mine: "only", yours: "one" }))).toEqual({ mine: 201, yours: 1 });
  });

  test("leave no gap while they are loading", () => {
    const loading = [...ASSETS.slice(0, 2), asset("mine", false, null)];
    for (const how of ["one", "more", "only"] as const)
      expect(counts(settingsWith({ mine: how }), loading)).toEqual(counts(settingsWith({})));
  });

  test("stand in the clearing, apart from each other and from the forest, at their own size", () => {
    const places = Array.from({ length: 9 }, (_, k) => clearingPlace(k));
    const forest = placeTrees(2000, DEFAULTS.forestSeed);
    for (const place of places) {
      expect([glade(place.x_m, place.z_m) > 0.5, place.scale]).toEqual([true, 1]);
      const others = [...forest, ...places].filter(({ id }) => id !== place.id);
      for (const { x_m, z_m } of others)
        expect(Math.hypot(x_m - place.x_m, z_m - place.z_m)).toBeGreaterThan(2.5);
      expect(forest.some(({ id }) => id === place.id)).toBe(false);
    }
  });

  test("are part of links and of the placement that a shared forest exchanges", () => {
    const settings = settingsWith({ a1: "one", "b-2": "only", c: "more" });
    expect(textOfPlanted(settings.planted)).toBe("a1,b-2:only,c:more");
    expect(settingsFromQuery(queryFromSettings(settings)).planted).toEqual(settings.planted);
    expect(plantedFrom("a,,b:tree,../c,d:more")).toEqual({ a: "one", d: "more" });
    const other = settingsWith({ mine: "one" });
    expect(foreignPlacement(other, placementOf(settings)).planted).toEqual(settings.planted);
  });

  test("keep their order, and can be removed", () => {
    const settings = settingsFromQuery("tree=mine:more");
    expect(plantedAs(settings, "mine")).toBe("more");
    plantAs(settings, "mine", null);
    expect(plantedAs(settings, "mine")).toBeNull();
    plantAs(settings, "mine", "one");
    plantAs(settings, "yours", "more");
    plantAs(settings, "mine", "only");
    expect(Object.entries(settings.planted)).toEqual([["mine", "only"], ["yours", "more"]]);
  });
});

test("in a shared forest a tree is planted for all once it is loaded, and only then", () => {
  const store = new Store(settingsWith({}), DEFAULTS, "?share=meadow");
  const sent: boolean[] = [];
  const assetChanges = signal(0);
  const order = { awaitsFirst: false };
  const catalogue = { isLoaded: false, order, assets: [], leafMotion: () => null, find: () => null, assetChanges };
  const client = { plan: (_: unknown, plan: { share: { replant: boolean } }) => sent.push(plan.share.replant) };
  const world = { client, prepare: () => {} };
  new Planting(store, world as never, catalogue as never, { arrivals: signal(0) } as never);
  plantAs(store.settings, "mine", "one");
  expect(sent).toEqual([]);
  catalogue.isLoaded = true;
  assetChanges.value++;
  assetChanges.value++;
  expect(sent).toEqual([true, false]);
  store.adopt({ trees: 30 }); // the others have planted these
  expect(sent).toEqual([true, false, false]);
});

test("in a shared forest own trees are planted for all once they are loaded; until then the page's forest is its own", () => {
  const store = new Store({ ...settingsWith({}), ownTrees: 1 }, DEFAULTS, "?share=meadow");
  const { state, settings } = store;
  const sent: unknown[] = [];
  const motion = { sha256: "a", stride: 1 } as unknown as TreeAsset["motion"];
  const moving = { ...ASSETS[0], motion };
  const catalogue = {
    isLoaded: true, order: { awaitsFirst: false }, assets: [moving], leafMotion: () => motion, find: () => null,
    assetChanges: signal(0),
  };
  const client = {
    plan: (groups: { key: string }[], { share }: { share: { replant: boolean; about: unknown } | null }) =>
      sent.push([groups.map(({ key }) => key).join(), share && share.replant]),
  };
  state.growth = { at: "growing", done: 0, all: 1 };
  new Planting(store, { client, prepare: () => {} } as never, catalogue as never, { arrivals: signal(0) } as never);
  expect(sent).toEqual([["ash", null]]);
  settings.density = 1.2; // waits for the trees
  expect(sent).toHaveLength(1);

  const tree = { id: "own", species: "ash", form: "open", height_m: 8, dbh_cm: null } as const;
  const own = { ...asset("own", false), species: "ash", motion } as TreeAsset;
  Object.assign(catalogue, { isLoaded: false, assets: [moving, { ...own, model: null }] });
  state.individuals = [tree];
  state.growth = { at: "planted", trees: 1, shown: 200, all: 200 };
  expect(sent).toHaveLength(1);
  Object.assign(catalogue, { isLoaded: true, assets: [moving, own] });
  catalogue.assetChanges.value++;
  expect(sent.slice(1)).toEqual([["own", true]]);

  // others have chosen none; then this visitor chooses one again, which is refused
  store.adopt({ ownTrees: 0 });
  state.individuals = [];
  settings.ownTrees = 1;
  state.growth = { at: "growing", done: 0, all: 1 };
  state.growth = { at: "refused", title: "", hint: "", final: false };
  expect(sent.slice(2)).toEqual([["ash", false], ["ash", true]]);
});

test("the own trees of a private forest are planted once, when the last one is loaded", () => {
  const store = new Store(settingsWith({}), DEFAULTS, "");
  const { state, settings } = store;
  const motion = { sha256: "a", stride: 1 } as unknown as TreeAsset["motion"];
  const moving = { ...ASSETS[0], motion };
  const individuals = ["own-1", "own-2"].map((id, k) => ({ id, species: "ash", form: "open" as const, height_m: 7 + k, dbh_cm: null }));
  const own = individuals.map(({ id }) => ({ ...asset(id, false), species: "ash", motion }) as TreeAsset);
  const catalogue = {
    isLoaded: true, order: { awaitsFirst: false }, assets: [moving], leafMotion: () => motion, find: () => null,
    assetChanges: signal(0),
  };
  const sent: string[] = [];
  const client = { plan: (groups: { key: string }[]) => sent.push(groups.map(({ key }) => key).join()) };
  new Planting(store, { client, prepare: () => {} } as never, catalogue as never, { arrivals: signal(0) } as never);
  settings.ownTrees = 2;
  for (const done of [0, 1]) state.growth = { at: "growing", done, all: 2 };
  Object.assign(catalogue, { isLoaded: false, assets: [moving, own[0], { ...own[1], model: null }] });
  state.individuals = individuals;
  catalogue.assetChanges.value++;
  expect(sent).toEqual(["ash"]);
  Object.assign(catalogue, { isLoaded: true, assets: [moving, ...own] });
  catalogue.assetChanges.value++;
  expect(sent).toEqual(["ash", "own-1,own-2"]);
});

/**
 * Two species, whose models and tables arrive one after the other; returns how many plans there were before and after a wait. `moving`
 * receives the number of moving trees of each.
 */
function plantingOf(trees: number, waited: boolean, awaitsFirst = false, moving: number[] = [], query = ""): number[] {
  const store = new Store(settingsWith({}), { ...DEFAULTS, trees }, query);
  store.settings.trees = trees;
  const model = { height_m: 10, radius_m: 2 };
  const asset = (id: string) => ({ id, species: id, builtin: true, form: "open", hasTable: true, model: null as object | null, motion: null as object | null });
  const assets = [asset("poplar"), asset("maple")];
  const assetChanges = signal(0);
  const order = { awaitsFirst };
  const catalogue = { isLoaded: false, order, assets, leafMotion: () => null, find: () => null, assetChanges };
  let plans = 0;
  const plan = (groups: { ids: Uint32Array }[]) => {
    plans++;
    moving.push(groups.reduce((sum, { ids }) => sum + ids.length, 0));
  };
  const world = { client: { plan }, prepare: () => {} };
  new Planting(store, world as never, catalogue as never, { arrivals: signal(0) } as never);
  const arrive = (act: () => void) => {
    act();
    assetChanges.value++;
    return plans;
  };
  return [
    arrive(() => Object.assign(assets[0], { model })),
    arrive(() => waited && vi.runAllTimers()),
    arrive(() => Object.assign(assets[0], { motion: { sha256: "a" } })),
    arrive(() => Object.assign(assets[1], { model })),
    arrive(() => {
      Object.assign(assets[1], { motion: { sha256: "b" } });
      catalogue.isLoaded = true;
    }),
  ];
}

describe("the first trees", () => {
  beforeEach(() => vi.useFakeTimers());
  afterEach(() => vi.useRealTimers());

  test("are planted together if all arrive soon", () => {
    expect(plantingOf(120, false)).toEqual([0, 0, 0, 0, 1]);
  });

  test("are planted one after the other if they take long", () => {
    expect(plantingOf(20_000, true)).toEqual([0, 2, 3, 4, 5]);
  });

  test("do not wait for others that wait for the first one", () => {
    expect(plantingOf(120, false, true)).toEqual([1, 2, 3, 4, 5]);
  });

  test("of a large forest are planted when they move, and again when all are loaded", () => {
    const moving: number[] = [];
    expect(plantingOf(20_001, true, false, moving)).toEqual([0, 2, 3, 3, 4]);
    // at first those in the centre, of one species
    expect(moving[2]).toBeGreaterThan(800);
    expect(moving[2]).toBeLessThan(2000);
    expect(moving[3]).toBe(20_001);
  });

  test("of a large forest stand everywhere if a link has a view of its own", () => {
    const moving: number[] = [];
    plantingOf(20_001, true, false, moving, "?view=400,20,0,380,10,0");
    expect(moving[2]).toBeGreaterThan(8000);
  });
});

describe("the uploads of this browser", () => {
  const shelf = (text: string | null = null) => {
    const kept = { text };
    return () => ({
      getItem: () => kept.text,
      setItem: (_: string, value: string) => {
        kept.text = value;
      },
    });
  };

  test("are planted on the next visit, as they were left", () => {
    const store = shelf();
    const uploads = new OwnUploads(store);
    for (const id of ["first", "second", "third"]) uploads.add(id, id !== "third");
    uploads.change("first", { planted: null });
    uploads.change("second", { planted: "more", shown: true });
    const next = new OwnUploads(store);
    expect(next.plantedWith({ link: "one", third: "only" })).toEqual({ second: "more", third: "only", link: "one" });
    expect(next.find("second")).toEqual({ id: "second", planted: "more", shown: true, started: true });
    next.forget("second");
    expect(new OwnUploads(store).find("second")).toBeNull();
  });

  test("unreadable or blocked storage is ignored", () => {
    for (const text of ["{", "[]", '{"version":9,"uploads":[]}', '{"version":1,"uploads":[3,{"id":"../x"}]}'])
      expect(new OwnUploads(shelf(text)).plantedWith({})).toEqual({});
    const blocked = new OwnUploads(() => {
      throw new Error("blocked");
    });
    blocked.add("mine", true);
    expect(blocked.plantedWith({})).toEqual({ mine: "one" });
  });
});

describe("remaining time", () => {
  test("counts down between reports, and ends with words instead of a wrong number", () => {
    const time = new RemainingTime();
    time.report(null, 0);
    expect(time.left(1)).toBeNull();
    time.report(40, 10);
    time.report(40, 25); // the same report again, with another change of the tree
    expect([time.left(10), time.left(30), time.left(50), time.left(59)]).toEqual([40, 20, 0, 0]);
    expect(time.left(61)).toBe("late");
    time.report(15, 62);
    time.report(14, 63);
    expect(time.left(63)).toBeCloseTo(14, 9);
  });

  test("of estimates with a scatter of 40 % it is nearer to the truth than they are (seeds 1 to 20)", () => {
    for (let seed = 1; seed <= 20; seed++) {
      const next = random(seed);
      const time = new RemainingTime();
      const [own, given] = [[] as number[], [] as number[]];
      for (let now_s = 0; now_s < 100; now_s += 2) {
        const estimate_s = (100 - now_s) * (0.6 + 0.8 * next());
        time.report(estimate_s, now_s);
        own.push(((time.left(now_s) as number) - (100 - now_s)) ** 2);
        given.push((estimate_s - (100 - now_s)) ** 2);
      }
      const sum = (values: number[]) => values.reduce((all, one) => all + one, 0);
      expect(sum(own), `seed ${seed}`).toBeLessThan(0.95 * sum(given));
    }
  });

  test("in words", () => {
    expect([timeLeft(22), timeLeft(3), timeLeft("late")]).toEqual([
      "about 20 s left",
      "a few seconds left",
      "longer than expected",
    ]);
    expect(sendingWords(0.25, 10)).toBe("Sending the file, about 30 s left");
    expect(sendingWords(0.25, 0.1)).toBe("Sending the file");
    expect(sendingWords(1, 12)).toBe("Reading the mesh on the server");
  });
});

test("errors of a computation say what to do", () => {
  expect(faultOf({ error: "The mesh has no trunk. Check the up axis." })).toBe("The mesh has no trunk. Check the up axis.");
  expect(faultOf({ error: "The process ended" })).toMatch(/^The process ended Try again\./);
  expect(faultOf({ error: null })).toMatch(/Try again/);
});

test("the view of a tree in the clearing is not blocked by a trunk, from the sunny side where possible", () => {
  const forest = placeTrees(400, 7).map(({ x_m, z_m, scale }) => ({ x: x_m, z: z_m, height_m: 18 * scale }));
  for (let k = 0; k < 4; k++) {
    const { x_m: x, z_m: z } = clearingPlace(k);
    const subject = { x, z, height_m: 9 };
    const { eye, target } = treeView(subject, forest, { x: 1, z: 0.3 }, 1.6);
    for (const tree of forest) {
      const t = ((tree.x - x) * (eye.x - x) + (tree.z - z) * (eye.z - z)) / ((eye.x - x) ** 2 + (eye.z - z) ** 2);
      const at = Math.min(1, Math.max(0, t));
      const apart_m = Math.hypot(tree.x - x - at * (eye.x - x), tree.z - z - at * (eye.z - z));
      expect(apart_m).toBeGreaterThan(1);
    }
    expect(Math.hypot(eye.x - target.x, eye.z - target.z)).toBeCloseTo(1.55 * 9, 6);
  }
  const alone = treeView({ x: 0, z: 0, height_m: 10 }, [], { x: 0, z: 1 }, 1.6);
  expect(alone.eye.z).toBeGreaterThan(0);
  const portrait = treeView({ x: 0, z: 0, height_m: 10 }, [], { x: 0, z: 1 }, 0.5);
  expect(Math.hypot(portrait.eye.x, portrait.eye.z)).toBeCloseTo(1.6 * 15.5, 6);
});
