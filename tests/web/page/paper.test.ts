/** The paper's method: fetched on demand, and its state in words. */
import { signal } from "@preact/signals-core";
import { describe, expect, test, vi } from "vitest";
import { PaperMethod } from "../../../web/src/page/paper/paperMethod";
import { isRecorded, onlyExtrasLeft, paperNote, paperStateOf, paperWords } from "../../../web/src/page/paper/paperState";
import type { Job, Tree } from "../../../web/src/page/server/api";
import type { KnownTree } from "../../../web/src/page/server/catalogue";
import { DEFAULTS } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";
import { tableWords } from "../../../web/src/page/ui/words";
import type { TableMotion } from "../../../web/player/src/worker/protocol";
import { streamMethod } from "../../../web/player/src/worker/stream/forestRequest";

const toasts = vi.hoisted(() => [] as string[]);
vi.mock("../../../web/src/page/ui/toast", () => ({ showToast: (_: string, hint: string) => toasts.push(hint) }));

const motion = (given: Partial<TableMotion> = {}) =>
  ({ sha256: "t", hasRecords: false, preliminary: false, linear: false, leftOut: [], ...given }) as TableMotion;
const tree = (given: Partial<Tree> = {}) =>
  ({ id: "ash", name: "ash", state: "ready", table_sha256: "t", ...given }) as Tree;
const running = (stage: string, fraction = 0.4) => ({ id: "j", state: "running", stage, fraction }) as Job;
const known = (given: Partial<KnownTree> = {}): KnownTree => ({ tree: tree(), job: null, motion: motion(), ...given });

describe("the state of the paper's method", () => {
  test.each([
    ["not computed", known()],
    ["ready", known({ motion: motion({ hasRecords: true }) })],
    ["ready", known({ tree: tree({ records_sha256: "r" }) })],
    ["not computed", known({ tree: tree({ records_sha256: "r", table_sha256: "newer" }) })],
    ["follows the full table", known({ job: running("sampling") })],
    ["being computed, 40 %", known({ job: running("records") })],
    ["ready", known({ job: running("records"), tree: tree({ records_sha256: "r" }) })],
    ["not computed", known({ job: { ...running("records"), state: "cancelled" } })],
    ["not computed", known({ job: running("bare") })],
    ["only in leaf", known({ motion: motion({ sha256: "b", foliage: "bare" }), tree: tree({ records_sha256: "r" }) })],
  ])("%s", (words, given) => expect(paperWords(paperStateOf(given, false))).toBe(words));

  test("loading comes first", () => expect(paperWords(paperStateOf(known(), true))).toBe("loading"));

  test("the note names the trees that cannot use it yet", () => {
    const noteOf = (...all: KnownTree[]) =>
      paperNote(all.map((one) => ({ known: one, state: paperStateOf(one, false) })));
    expect(noteOf(known({ motion: motion({ hasRecords: true }) }))).toBe("");
    expect(noteOf(known())).toBe("Ash: not computed\nUsing the modal model instead.");
    expect(noteOf(known({ job: running("records", 0.07) }))).toBe(
      "Ash: being computed, 7 %\nUsing the modal model until then.",
    );
    expect(noteOf(...Array.from({ length: 6 }, () => known())).split("\n")).toHaveLength(6);
  });

  test("a build of which only the records or the bare table are left is quiet", () => {
    expect(onlyExtrasLeft(running("records"))).toBe(true);
    expect(onlyExtrasLeft(running("bare"))).toBe(true);
    expect(onlyExtrasLeft(running("table"))).toBe(false);
    expect(onlyExtrasLeft(null)).toBe(false);
  });

  test("the server uses it only with the records of every tree", () => {
    expect(streamMethod("paper", [{ recorded: true }, { recorded: true }])).toBe("paper");
    expect(streamMethod("paper", [{ recorded: true }, { recorded: false }])).toBe("modal");
    expect(streamMethod("modal", [{ recorded: true }])).toBe("modal");
  });
});

test("a preliminary table says what it leaves out, and that another one follows", () => {
  const first = motion({ preliminary: true, linear: true, leftOut: ["large deflections", "gusts"] });
  expect(tableWords(null, null)).toBe("No motion yet.");
  expect(tableWords(motion(), running("records"))).toBe("Complete table.");
  expect(tableWords(motion({ foliage: "bare" }), null)).toBe("Complete table, without leaves.");
  expect(tableWords(first, running("sampling"))).toBe(
    "First motion from the natural modes; the full table follows. It leaves out: large deflections; gusts.",
  );
  expect(tableWords(motion({ preliminary: true }), null)).toBe("Preliminary table.");
  expect(tableWords(motion({ preliminary: true, leftOut: ["some runs"] }), running("sampling"))).toBe(
    "Preliminary table; the full table follows. It leaves out: some runs.",
  );
});

/** A page whose records files are delivered by the test. */
function started(trees: KnownTree[]) {
  const store = new Store({ ...DEFAULTS }, DEFAULTS, "");
  const asked: { table: string; records: string; resolve(): void; reject(error: Error): void }[] = [];
  const catalogue = { known: trees, assetChanges: signal(0), recordChanges: signal(0) };
  const paper = new PaperMethod(store, catalogue, {
    loadRecords: (table, records) =>
      new Promise((resolve, reject) => asked.push({ table, records, resolve, reject })),
  });
  const settle = () => new Promise((done) => setTimeout(done));
  return { store, settings: store.settings, asked, catalogue, paper, trees, settle };
}

describe("records are fetched", () => {
  test("once, and only when the paper's method is chosen and computed here", async () => {
    const { store, settings, asked, catalogue, paper, trees, settle } = started([
      known({ tree: tree({ records_sha256: "r" }) }),
    ]);
    catalogue.assetChanges.value++;
    store.change({ lookup: "server", method: "paper" });
    expect(asked).toHaveLength(0);
    expect(paper.moves(trees[0])).toBe(true);
    settings.lookup = "worker";
    catalogue.assetChanges.value++;
    expect(asked).toMatchObject([{ table: "t", records: "r" }]);
    expect(paper.note).toBe("Ash: loading\nUsing the modal model until then.");
    expect(paper.moves(trees[0])).toBe(false);
    asked[0].resolve();
    await settle();
    expect([paper.arrivals.value, paper.note, paper.moves(trees[0])]).toEqual([1, "", true]);
  });

  test("when the server has them at last", () => {
    const { settings, asked, catalogue, trees } = started([known({ job: running("records") })]);
    settings.method = "paper";
    expect(asked).toHaveLength(0);
    trees[0] = known({ tree: tree({ records_sha256: "r" }) });
    catalogue.recordChanges.value++;
    expect(asked).toHaveLength(1);
  });

  test("again after a failure, when the method is chosen again", async () => {
    const { settings, asked, catalogue, settle } = started([known({ tree: tree({ records_sha256: "r" }) })]);
    settings.method = "paper";
    asked[0].reject(new Error("these records belong to another table"));
    await settle();
    catalogue.assetChanges.value++;
    expect([toasts, asked.length]).toEqual([["these records belong to another table"], 1]);
    settings.method = "modal";
    settings.method = "paper";
    expect(asked).toHaveLength(2);
  });

  test("not for a table that holds them", () => {
    const { settings, asked, paper, trees } = started([known({ motion: motion({ hasRecords: true }) })]);
    settings.method = "paper";
    expect([asked.length, paper.note, paper.moves(trees[0]), isRecorded(trees[0])]).toEqual([0, "", true, true]);
  });
});

test("a forest that the server moves is placed again when the server has new records", () => {
  const { store, catalogue, paper } = started([known()]);
  catalogue.recordChanges.value++;
  expect(paper.arrivals.value).toBe(0);
  store.change({ lookup: "server", method: "paper" });
  catalogue.recordChanges.value++;
  expect(paper.arrivals.value).toBe(1);
});
