/** A forest that the server does not stream: the page computes its motion, and says so. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { FromWorker, ToWorker } from "../../../web/player/src/worker/protocol";
import { ForestClient } from "../../../web/src/page/forest/forestClient";
import { DEFAULTS } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";

const page = vi.hoisted(() => ({ toasts: [] as string[][] }));
vi.mock("../../../web/src/page/ui/toast", () => ({ showToast: (...words: string[]) => page.toasts.push(words) }));

class FakeWorker {
  static sent: ToWorker[] = [];
  static last: FakeWorker;
  onmessage: ((event: { data: FromWorker }) => void) | null = null;

  constructor() {
    FakeWorker.last = this;
  }

  postMessage(message: ToWorker): void {
    FakeWorker.sent.push(structuredClone(message));
  }
}

beforeEach(() => {
  FakeWorker.sent = [];
  page.toasts = [];
  vi.stubGlobal("Worker", FakeWorker);
  vi.stubGlobal("document", { baseURI: "https://forest.example/" });
  vi.stubGlobal("navigator", { hardwareConcurrency: 2 });
});
afterEach(() => vi.unstubAllGlobals());

function started() {
  const store = new Store({ ...DEFAULTS, lookup: "server" }, DEFAULTS, "?share=meadow");
  const client = new ForestClient(store);
  const plan = (replant: boolean) => {
    const share = { id: "meadow", replant, about: {} };
    const { lookup, method, poseEasing } = store.settings;
    client.plan([], { lookup, method, poseEasing, from_s: 0, share }, () => {});
    const { plan: sent } = FakeWorker.sent.findLast((one) => one.kind === "plan") as Extract<ToWorker, { kind: "plan" }>;
    return sent.share?.replant;
  };
  return { store, plan, tell: (data: FromWorker) => FakeWorker.last.onmessage?.({ data }) };
}

const REFUSAL = {
  kind: "problem",
  title: "A forest of 100,000 trees is played by the browsers: up to 20,000 are streamed",
  hint: 'Request mode "table".',
  code: "too-many-trees",
} as const;

test("a forest that is too large for the stream is moved by this browser from then on", () => {
  const { store, tell } = started();
  tell({ ...REFUSAL, code: "no-such-table" });
  expect(store.settings.lookup).toBe("server");
  const adopted: boolean[] = [];
  store.onChange(() => adopted.push(store.isAdopting));
  tell(REFUSAL);
  expect(store.settings.lookup).toBe("worker");
  expect(adopted).toEqual([true]); // it is not undone with the visitor's own changes
  expect(page.toasts).toEqual([
    [REFUSAL.title, REFUSAL.hint],
    [REFUSAL.title, "This browser computes the motion now."],
  ]);
});

test("trees replace those of others until the server has taken them, and not again", () => {
  const { plan, tell } = started();
  expect(plan(true)).toBe(true);
  tell(REFUSAL);
  expect(plan(false)).toBe(true);
  tell({ kind: "shared", about: {} });
  expect(plan(false)).toBe(false);
});
