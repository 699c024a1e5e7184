import { describe, expect, test } from "vitest";
import { problemFrom } from "../../../web/src/page/server/api";
import { fractalNoise, valueNoise } from "../../../web/player/src/core/math/noise";
import { hashUnit } from "../../../web/player/src/core/math/random";
import { leafTint } from "../../../web/src/scene/season/palette";
import { progressLine, statusLine, summary, timeLeft } from "../../../web/src/page/ui/words";
import { plainWind } from "../../../web/player/src/core/wind/edit";
import { parseWind } from "../../../web/player/src/core/wind/document";
import { WIND_LIMITS } from "../../../web/src/page/settings/windLimits";
import { DEFAULTS } from "../../../web/src/page/settings/settings";

describe("texts of the page", () => {
  test("progress line", () => {
    expect(progressLine({ state: "queued", stage: "import", seconds_left: null })).toBe("Waiting in the queue");
    expect(progressLine({ state: "running", stage: "sampling", seconds_left: 33 })).toBe(
      "Simulating winds, about 35 s left",
    );
    expect(timeLeft(240)).toBe("about 4 min left");
    expect(timeLeft(null)).toBe("");
  });

  test("the summary counts moving and static trees", () => {
    const listed = { known: true, computing: 0, loading: 0 };
    const none = { moving: 0, still: 0, loading: 0 };
    expect(summary({ ...none, moving: 1 }, listed)).toBe("1 tree, moving");
    expect(summary({ ...none, moving: 300, still: 100 }, { ...listed, computing: 1 })).toBe(
      "300 trees moving, 100 trees not computed yet",
    );
    expect(summary(none, { ...listed, computing: 3 })).toBe("The first trees are being computed");
    expect(summary(none, listed)).toBe("No trees yet");
  });

  test("what is only being loaded is not said to be computed", () => {
    const listed = { known: true, computing: 2, loading: 1 };
    const none = { moving: 0, still: 0, loading: 0 };
    expect(summary(none, listed)).toBe("Loading the trees");
    expect(summary(none, { ...listed, known: false, loading: 0 })).toBe("Loading the trees");
    expect(summary({ moving: 0, still: 9, loading: 9 }, listed)).toBe("9 trees loading");
    expect(summary({ moving: 30, still: 9, loading: 1 }, listed)).toBe(
      "30 trees moving, 8 trees not computed yet, 1 tree loading",
    );
  });

  test("the status line shows connection problems", () => {
    const connection = { state: "lost", latency_ms: null, frameAge_ms: null, kB_s: 0 } as const;
    expect(statusLine({ events: false, lookup: "worker", connection }).state).toBe("lost");
    expect(statusLine({ events: true, lookup: "worker", connection }).state).toBe("live");
    expect(statusLine({ events: true, lookup: "server", connection }).state).toBe("lost");
    const live = { ...connection, state: "live", latency_ms: 3.2 } as const;
    expect(statusLine({ events: true, lookup: "server", connection: live }).text).toMatch(/3 ms/);
  });

  test("a problem of the server keeps its title and hint; an HTML page gives a generic message", async () => {
    const body = JSON.stringify({ title: "This is no tree.", hint: "Send a GLB.", code: "not-a-mesh" });
    const problem = await problemFrom(new Response(body, { status: 415 }));
    expect([problem.title, problem.hint, problem.status]).toEqual(["This is no tree.", "Send a GLB.", 415]);
    const page = await problemFrom(new Response("<html>502</html>", { status: 502 }));
    expect(page.title).toMatch(/502/);
  });
});

test("every setting of the panel gives a valid wind document", () => {
  for (const mean_speed_m_s of [0, 0.1, WIND_LIMITS.mean_speed_m_s.max]) {
    expect(() => parseWind(plainWind({ ...DEFAULTS.wind, mean_speed_m_s }))).not.toThrow();
  }
});

describe("seeded noise", () => {
  test("stays in range and is continuous across cells", () => {
    for (let i = 0; i < 500; i++) {
      const x = 40 * (hashUnit(1, i) - 0.5);
      const z = 40 * (hashUnit(2, i) - 0.5);
      expect(Math.abs(fractalNoise(x, z, 5, 4))).toBeLessThanOrEqual(1);
      const edge = Math.round(x);
      expect(valueNoise(edge - 1e-9, z, 5)).toBeCloseTo(valueNoise(edge + 1e-9, z, 5), 6);
    }
  });

  test("hashes are uniform: each of ten bins holds 10 % of 10,000 draws, within 15 %", () => {
    const bins = new Array<number>(10).fill(0);
    for (let i = 0; i < 10_000; i++) bins[Math.floor(10 * hashUnit(77, i))]++;
    for (const bin of bins) expect(Math.abs(bin - 1000)).toBeLessThan(150);
  });
});

test("each tree has its own autumn colour, which is reproducible", () => {
  const colours = new Set(Array.from({ length: 40 }, (_, id) => leafTint("maple", id).join()));
  expect(colours.size).toBeGreaterThan(20);
  expect(leafTint("maple", 5)).toEqual(leafTint("maple", 5));
  expect(leafTint(null, 5)[3]).toBeLessThan(0.5);
});
