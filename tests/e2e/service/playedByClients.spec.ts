import { rmSync } from "node:fs";
import type { Page } from "@playwright/test";
import { expect, forest, SMALL, test, visitor } from "../forest";
import { copyOf, freePort, serve, STARTS_WITHIN_MS, stop, until } from "../server";

/** Records time (s) and sway (m) of every frame from now on. */
const record = (page: Page) =>
  page.evaluate(() => {
    const seen: [number, number][] = [];
    Object.assign(window, { seen });
    const look = () => {
      const { time_s, crownDisplacement_m } = window.galewood!;
      if (seen.at(-1)?.[0] !== time_s) seen.push([time_s, crownDisplacement_m[0]]);
      requestAnimationFrame(look);
    };
    look();
  });
const recorded = (page: Page) => page.evaluate(() => (window as unknown as { seen: [number, number][] }).seen);

/** The value between the two records around a time; null outside of them. */
function between(seen: readonly (readonly [number, number])[], time_s: number): number | null {
  const after = seen.findIndex(([at_s]) => at_s >= time_s);
  if (after < 1) return null;
  const [[from_s, from], [to_s, to]] = [seen[after - 1], seen[after]];
  return to_s - from_s > 0.5 ? null : from + ((time_s - from_s) / (to_s - from_s)) * (to - from);
}

test("two pages play a shared forest that is too large for the server: the same trees in the same wind", { tag: "@long" }, async ({ page, browser }) => {
  const source = process.env.SERVER_DATA;
  test.skip(!source, "needs a server with a setting of its own");
  const data = copyOf(source ?? "");
  const port = await freePort();
  const base = `http://127.0.0.1:${port}`;
  const server = serve(port, data, { GALEWOOD_FOREST_TREES: "12" });
  const other = await visitor(browser);
  const state = (of: Page) => of.evaluate(() => window.galewood!.connection.state);
  try {
    await until("the server", STARTS_WITHIN_MS, async () => (await fetch(`${base}/healthz`)).ok);
    const small = `${SMALL}&share=wide&speed=9&gust=0.9`;
    // It asks for a stream of 40 trees, which the server refuses.
    await page.goto(`${base}/?${small.replace("trees=6", "trees=40").replace("panel=0", "panel=1")}&lookup=server`);
    await expect(page.getByText(/A forest of 4\d trees is played by the browsers: up to 12 are streamed/)).toBeVisible();
    await expect.poll(() => page.evaluate(() => window.galewood?.lookup)).toBe("worker");
    await forest(page);
    await expect.poll(() => state(page)).toBe("live");
    // This one would like six trees of the stream, learns of the others, and plays them too.
    await other.goto(`${base}/?${small}&lookup=server&speed=2`);
    await expect.poll(() => other.evaluate(() => window.galewood?.lookup)).toBe("worker");
    const trees = (of: Page) => of.evaluate(() => window.galewood?.trees.moving ?? 0);
    await expect.poll(async () => (await trees(other)) === (await trees(page))).toBe(true);
    expect(await trees(page)).toBeGreaterThanOrEqual(40);
    await expect.poll(() => state(other)).toBe("live");
    expect((await other.evaluate(() => window.galewood!.wind)).mean_speed_m_s).toBe(9);
    await Promise.all([record(page), record(other)]);

    // Trees forget within seconds how they began; then both pages show the same sway at the same time of the forest.
    await expect
      .poll(async () => {
        const [mine, theirs] = await Promise.all([recorded(page), recorded(other)]);
        const from_s = Math.max(mine[0][0], theirs[0][0]) + 10;
        const pairs = mine.flatMap(([time_s, value]) => {
          const shown = time_s > from_s ? between(theirs, time_s) : null;
          return shown === null ? [] : [[value, shown]];
        });
        const mean = pairs.reduce((sum, [value]) => sum + value, 0) / pairs.length;
        const spread = Math.sqrt(pairs.reduce((sum, [value]) => sum + (value - mean) ** 2, 0));
        const apart = Math.sqrt(pairs.reduce((sum, [value, shown]) => sum + (value - shown) ** 2, 0));
        return pairs.length < 40 ? "too few frames" : apart < 0.2 * spread ? "alike" : `apart by ${apart / spread}`;
      })
      .toBe("alike");
    // and at the same time of the day: each is asked between two answers of the other
    const time_s = (of: Page) => of.evaluate(() => window.galewood!.time_s);
    await expect
      .poll(async () => {
        const [before_s, theirs_s, after_s] = [await time_s(page), await time_s(other), await time_s(page)];
        return theirs_s > before_s - 0.5 && theirs_s < after_s + 0.5;
      })
      .toBe(true);

    // Whoever changes the wind changes it for everyone.
    await other.evaluate(() => window.galewood!.setWind({ ...window.galewood!.wind, mean_speed_m_s: 4.5 }));
    await expect.poll(async () => (await page.evaluate(() => window.galewood!.wind)).mean_speed_m_s).toBe(4.5);
  } finally {
    await Promise.all([page.goto("about:blank"), other.context().close()]);
    await stop(server);
    rmSync(data, { recursive: true, force: true });
  }
});
