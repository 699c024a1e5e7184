import { describe, expect, test, vi } from "vitest";
import { FrameLoop } from "../../../web/src/page/forest/frameLoop";
import { isFrameDue } from "../../../web/src/page/forest/frameStatistics";
import type { World } from "../../../web/src/page/forest/world";
import { DEFAULTS } from "../../../web/src/page/settings/settings";
import { Store } from "../../../web/src/page/store/store";

/** Number of frames drawn in ten seconds on a display with this rate, whose refreshes come up to 0.5 ms early or late. */
function drawn(display_hz: number, limit_hz: number): number {
  let last_ms = 0;
  let count = 0;
  for (let k = 1; k <= 10 * display_hz; k++) {
    const now_ms = (1000 * k) / display_hz + (k % 2 ? 0.5 : -0.5);
    if (!isFrameDue(now_ms - last_ms, limit_hz)) continue;
    last_ms = now_ms;
    count++;
  }
  return count;
}

describe("the limit of the frame rate", () => {
  test("draws every second or fourth picture of a display of 60 Hz", () => {
    expect(drawn(60, 30)).toBe(300);
    expect(drawn(60, 15)).toBe(150);
  });

  test("leaves out nothing at the limit of a fast display, and never draws more than allowed", () => {
    expect(drawn(144, 240)).toBe(1440);
    for (const limit_hz of [5, 24, 50]) expect(drawn(144, limit_hz)).toBeLessThanOrEqual(1.02 * 10 * limit_hz);
  });
});

describe("the first pictures", () => {
  /** A loop whose graphics finish a picture when `finished` is set; `refresh` is a refresh of the display. */
  function opening() {
    const graphics = { finished: false, draws: 0 };
    let refresh: (now_ms: number) => void = () => {};
    const stage = {
      renderer: { setAnimationLoop: (callback: typeof refresh) => (refresh = callback) },
      fence: () => () => graphics.finished,
    };
    const world = { stage, hasTrees: true, isUnseen: false, moveTrees: vi.fn(), moveScenery: vi.fn() };
    const draw = () => ++graphics.draws;
    const client = { time_s: 1 };
    const store = new Store(DEFAULTS, DEFAULTS, "");
    const meter = { count: vi.fn() };
    const loop = new FrameLoop(
      store,
      { ...world, draw, client } as unknown as World,
      { isLoaded: false as never },
      meter as never,
      [],
    );
    loop.start();
    let now_ms = performance.now();
    const refreshes = (count: number) => {
      for (let k = 0; k < count; k++) refresh((now_ms += 20));
    };
    return { graphics, store, refreshes };
  }

  test("wait for each other, so that slow graphics show each of them as soon as it is drawn", () => {
    const { graphics, store, refreshes } = opening();
    refreshes(5);
    expect(graphics.draws).toBe(1);
    graphics.finished = true;
    refreshes(1);
    expect(graphics.draws).toBe(2);
    graphics.finished = false;
    refreshes(5);
    expect(graphics.draws).toBe(2);
    expect(store.state.treesSeen).toBe(false);
  });

  test("wait no longer once the trees have been seen to move", () => {
    const { graphics, store, refreshes } = opening();
    graphics.finished = true;
    refreshes(3);
    expect(store.state.treesSeen).toBe(true);
    graphics.finished = false;
    refreshes(4);
    expect(graphics.draws).toBe(7);
  });
});
