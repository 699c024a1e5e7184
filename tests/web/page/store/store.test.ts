/** The store of the page: signals, subscriptions, undo, and what is kept in address and storage. */
import { effect } from "@preact/signals-core";
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { Undo } from "../../../../web/src/page/controls/undo";
import { DEFAULTS, type Settings, settingsFromQuery } from "../../../../web/src/page/settings/settings";
import { remembered, rememberSettings } from "../../../../web/src/page/settings/storedSettings";
import { reactive, watch } from "../../../../web/src/page/store/signals";
import { Store } from "../../../../web/src/page/store/store";

const buttons = vi.hoisted(() => new Map<string, { disabled: boolean; pressed(): void }>());
vi.mock("../../../../web/src/page/controls/tools", () => ({
  tool: (name: string, _: string, pressed: () => void) => {
    const made = { disabled: false, pressed };
    buttons.set(name, made);
    return made;
  },
}));

const storeWith = (settings: Partial<Settings> = {}, query = "") => new Store({ ...DEFAULTS, ...settings }, DEFAULTS, query);

describe("a reactive object", () => {
  test("looks like a plain one", () => {
    const settings = reactive({ ...DEFAULTS });
    expect({ ...settings }).toEqual(DEFAULTS);
    expect(JSON.stringify(settings)).toBe(JSON.stringify(DEFAULTS));
  });

  test("runs an effect again only for what it has read", () => {
    const wind = reactive({ speed: 1, gusts: 2 });
    const seen: number[] = [];
    effect(() => {
      seen.push(wind.speed);
    });
    wind.gusts = 3;
    wind.speed = 4;
    wind.speed = 4;
    expect(seen).toEqual([1, 4]);
  });
});

describe("a subscription", () => {
  test("begins with the first change, knows the values before, and can be ended", () => {
    const wind = reactive({ speed: 1, gusts: 2 });
    const seen: unknown[] = [];
    const end = watch(
      () => [wind.speed],
      (now, before) => seen.push([now, before, wind.gusts]),
    );
    wind.gusts = 5; // is read by the subscriber only
    wind.speed = 3;
    end();
    wind.speed = 4;
    expect(seen).toEqual([[[3], [1], 5]]);
  });

  test("may change what others follow: they are told once, with the last value", () => {
    const chain = reactive({ first: 0, second: 0 });
    const seen: number[] = [];
    watch(
      () => [chain.first],
      ([first]) => {
        chain.second = 10 * first;
      },
    );
    watch(
      () => [chain.first, chain.second],
      ([, second]) => seen.push(second),
    );
    chain.first = 1;
    expect(seen).toEqual([10]);
  });
});

describe("the store", () => {
  test("announces several settings at once, and says which", () => {
    const store = storeWith();
    const changes: (readonly string[])[] = [];
    store.onChange((keys) => changes.push(keys));
    store.change({ season: "winter", daytime: 0.1 });
    store.change({ season: "winter" });
    store.settings.trees = 7;
    expect(changes).toEqual([["season", "daytime"], ["trees"]]);
  });

  test("says during a change whether others have made it", () => {
    const store = storeWith();
    const adopted: boolean[] = [];
    store.onChange(() => adopted.push(store.isAdopting));
    store.adopt({ trees: 5 });
    store.settings.trees = 6;
    expect(adopted).toEqual([true, false]);
  });

  test("a subscriber that fails leaves the others informed, and the change is over afterwards", () => {
    const store = storeWith();
    const seen: number[] = [];
    store.onChange(() => {
      throw new Error("broken");
    });
    store.onChange(() => seen.push(store.settings.trees));
    expect(() => store.adopt({ trees: 5 })).toThrow("broken");
    expect([seen, store.isAdopting]).toEqual([[5], false]);
  });

  test("begins with what the address says", () => {
    const store = storeWith({}, "?share=meadow&view=1,2,3,4,5,6&at=12");
    expect(store.state.share).toBe("meadow");
    expect(store.opened).toMatchObject({ eye: [1, 2, 3], target: [4, 5, 6], clouds: null });
    expect([store.from_s, storeWith().from_s]).toEqual([12, 0]);
  });
});

describe("undo", () => {
  beforeEach(() => vi.stubGlobal("addEventListener", () => {}));
  afterEach(() => vi.unstubAllGlobals());
  const press = (name: string) => buttons.get(name)?.pressed();
  const possible = () => [buttons.get("undo")?.disabled, buttons.get("redo")?.disabled].map((off) => !off);

  test("restores the settings and announces what differs", () => {
    const store = storeWith();
    new Undo(store);
    expect(possible()).toEqual([false, false]);
    store.change({ season: "winter", trees: 9 });
    store.settings.shares = { maple: 0.5 };
    const changes: (readonly string[])[] = [];
    store.onChange((keys) => changes.push(keys));
    press("undo");
    expect([store.settings.shares, store.settings.trees, possible()]).toEqual([DEFAULTS.shares, 9, [true, true]]);
    press("undo");
    expect({ ...store.settings }).toEqual(DEFAULTS);
    press("redo");
    expect(store.settings).toMatchObject({ season: "winter", trees: 9 });
    expect(changes).toEqual([["shares"], ["trees", "season"], ["trees", "season"]]);
  });

  test("is not for what others have changed", () => {
    const store = storeWith();
    new Undo(store);
    store.adopt({ trees: 5 });
    expect(possible()).toEqual([false, false]);
    store.settings.density = 2;
    press("undo");
    expect(store.settings).toMatchObject({ trees: 5, density: DEFAULTS.density });
  });
});

describe("address and storage", () => {
  const page = { address: "", kept: null as string | null };
  const localStorage = {
    getItem: () => page.kept,
    setItem: (_: string, value: string) => {
      page.kept = value;
    },
  };
  beforeEach(() => {
    Object.assign(page, { address: "?before", kept: null });
    vi.stubGlobal("localStorage", localStorage);
    vi.stubGlobal("location", { pathname: "/" });
    vi.stubGlobal("history", {
      replaceState: (_: unknown, __: string, address: string) => {
        page.address = address;
      },
    });
  });
  afterEach(() => vi.unstubAllGlobals());

  test("follow every change, but not the start", () => {
    const store = storeWith();
    rememberSettings(store);
    expect(page.address).toBe("?before");
    store.settings.trees = 60;
    expect(page.address).toBe("?trees=60");
    expect(remembered(DEFAULTS, () => localStorage).trees).toBe(60);
    store.settings.trees = DEFAULTS.trees;
    expect(page.address).toBe("/");
  });

  test("of a shared forest only the address", () => {
    const store = storeWith();
    rememberSettings(store);
    store.state.share = "meadow";
    store.settings.season = "winter";
    expect(page.kept).toBeNull();
    expect(settingsFromQuery(page.address).season).toBe("winter");
    expect(new URLSearchParams(page.address).get("share")).toBe("meadow");
  });

  test("of a page without controls nothing is stored", () => {
    const store = storeWith({ panel: false });
    rememberSettings(store);
    store.settings.trees = 60;
    expect([page.kept, settingsFromQuery(page.address).trees]).toEqual([null, 60]);
  });
});

test("what suits the graphics changes quality, number of trees and what is usual, and nothing else", () => {
  const store = storeWith({ season: "winter" });
  const usual: Settings = { ...DEFAULTS, quality: "low", trees: 120 };
  store.suit(usual, usual);
  expect({ ...store.settings }).toEqual({ ...DEFAULTS, season: "winter", quality: "low", trees: 120 });
  expect(store.defaults).toBe(usual);
});
