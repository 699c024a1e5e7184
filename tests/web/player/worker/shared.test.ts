import { describe, expect, test } from "vitest";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { DEFAULTS } from "../../../../web/src/page/settings/settings";
import { foreignPlacement, placementOf, sharedFrom, withShared } from "../../../../web/src/page/settings/sharedForest";
import { forestRequest, sharedGroups } from "../../../../web/player/src/worker/stream/forestRequest";
import { ServerClock } from "../../../../web/player/src/worker/stream/serverClock";
import { SharedClock } from "../../../../web/player/src/worker/stream/sharedClock";
import { random } from "../../golden";

describe("a shared forest in the address", () => {
  test.each([
    ["?share=meadow_7-b&trees=5", "meadow_7-b"],
    ["?trees=5", null],
    ["?share=", null],
    ["?share=../etc", null],
    [`?share=${"a".repeat(65)}`, null],
  ])("%s", (query, id) => {
    expect(sharedFrom(query)).toBe(id);
  });

  test("is kept in links", () => {
    expect(withShared("trees=5", "meadow")).toBe("trees=5&share=meadow");
    expect(withShared("trees=5", null)).toBe("trees=5");
  });
});

test("clients exchange only the settings that determine the placement", () => {
  const mine = { ...DEFAULTS, trees: 321, forestSeed: 9, form: "open" as const, ownTrees: 12, method: "paper" as const, wind: PRESETS.still };
  const yours = { ...DEFAULTS, trees: 5, wind: PRESETS["storm-front"] };
  const taken = foreignPlacement(yours, placementOf(mine));
  expect(taken).toEqual({ trees: 321, forestSeed: 9, method: "paper", form: "open", ownTrees: 12 });
  expect(foreignPlacement({ ...yours, ...taken }, placementOf(mine))).toEqual({});
  expect(foreignPlacement(yours, {})).toEqual({});
  expect(foreignPlacement(mine, placementOf({ ...mine, inventory: "api/inventory" }))).toEqual({ inventory: "api/inventory" });
  const { trees, forestSeed, form, method, ownTrees } = DEFAULTS;
  expect(foreignPlacement(mine, placementOf(DEFAULTS))).toEqual({ trees, forestSeed, form, method, ownTrees });
});

test("a shared forest is asked for by its tables in leaf, whichever ones are played here", () => {
  const placement = Float32Array.of(1, 2, 3, 1);
  const group = { table: "bare", leafTable: "leaf", placement, ids: Uint32Array.of(4) };
  expect(sharedGroups([group])).toEqual([{ ...group, table: "leaf" }]);
  const field = new WindField(DEFAULTS.wind);
  const options = { method: "modal", poseEasing: null, share: { id: "meadow", replant: false, about: {} } } as const;
  const { groups } = forestRequest("table", sharedGroups([group]), field, 0, options);
  expect(groups).toEqual([{ table: "leaf", count: 1 }]);
});

/** A server whose clock is ahead, and which answers pings after random network delays. */
function network(seed: number) {
  const next = random(seed);
  const ahead_ms = 1e6 * next();
  const clock = new ServerClock();
  const ping = (now_ms: number) => {
    const [there_ms, back_ms] = [5 + 40 * next(), 5 + 40 * next()];
    clock.pong(now_ms, now_ms + there_ms + back_ms, (now_ms + there_ms + ahead_ms) / 1000);
  };
  return { clock, ping, server_s: (now_ms: number) => (now_ms + ahead_ms) / 1000 };
}

test("the server clock is estimated to within half the shortest round trip (seeds 1 to 20)", () => {
  for (let seed = 1; seed <= 20; seed++) {
    const { clock, ping, server_s } = network(seed);
    expect(clock.age_ms(0, 0)).toBeNull();
    for (let k = 0; k < 30; k++) ping(1000 * k);
    expect(Math.abs((clock.age_ms(server_s(40_000), 40_000) ?? Number.NaN) - 0)).toBeLessThan(20);
  }
});

describe("displays of a shared forest", () => {
  test("converge to the same time and never go back (seeds 3 and 4)", () => {
    const displays = [3, 4].map((seed) => {
      const net = network(seed);
      return { net, shared: new SharedClock(net.clock), time_s: seed * 10, next: random(seed + 100) };
    });
    for (let now_ms = 0; now_ms < 20_000; now_ms += 16) {
      for (const display of displays) {
        const { net, shared } = display;
        if (now_ms % 1008 === 0) {
          net.ping(now_ms);
          shared.update({ type: "clock", time_s: 500 + now_ms / 1000, made_s: net.server_s(now_ms), paused: false });
        }
        const before_s = display.time_s;
        const step = shared.step(display.time_s, 0.016 * (0.9 + 0.2 * display.next()), now_ms);
        display.time_s = (step.jump_s ?? display.time_s) + step.dt_s;
        if (now_ms > 2000) expect(display.time_s).toBeGreaterThanOrEqual(before_s);
      }
    }
    for (const { time_s } of displays) expect(Math.abs(time_s - 520)).toBeLessThan(0.06);
  });

  test("stop at the time of a pause", () => {
    const net = network(5);
    const shared = new SharedClock(net.clock);
    net.ping(0);
    shared.update({ type: "clock", time_s: 60, made_s: net.server_s(0), paused: true });
    let time_s = 59.8;
    for (let now_ms = 0; now_ms < 5000; now_ms += 16) time_s += shared.step(time_s, 0.016, now_ms).dt_s;
    expect(time_s).toBeCloseTo(60, 2);
    expect(shared.step(10, 0.016, 5000)).toEqual({ jump_s: 60, dt_s: 0 });
  });
});
