/** When the controls of the page are shown, and the others loaded. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { openControls } from "../../../web/src/page/controls/opening";
import { DEFAULTS } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";

/** What happened, in order. */
const told: string[] = [];

beforeEach(() => {
  told.length = 0;
  vi.useFakeTimers();
  const classList = { remove: (name: string) => told.push(`without ${name}`) };
  vi.stubGlobal("document", { body: { classList } });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const started = () => {
  const store = new Store(DEFAULTS, DEFAULTS, "");
  openControls(store, () => told.push("loading"));
  return store.state;
};

test("the controls open once, after the first trees have moved", () => {
  const state = started();
  vi.advanceTimersByTime(500);
  expect(told).toEqual([]);
  state.treesSeen = true;
  expect(told).toEqual([]);
  vi.advanceTimersByTime(200);
  expect(told).toEqual(["without opening", "loading"]);
  vi.advanceTimersByTime(10_000);
  expect(told).toHaveLength(2);
});

test("they do not wait long for trees, and open once if these come later", () => {
  const state = started();
  vi.advanceTimersByTime(2000);
  expect(told).toEqual(["without opening", "loading"]);
  state.treesSeen = true;
  vi.advanceTimersByTime(10_000);
  expect(told).toHaveLength(2);
});
