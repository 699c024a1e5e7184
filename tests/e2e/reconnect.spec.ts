import { cpSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, forest, SMALL, sway_m, test } from "./forest";
import { freePort, serve, STARTS_WITHIN_MS, stop, until } from "./server";

/** What a second server needs of the first one's data: not the cache of its computations. */
function copyOf(data: string): string {
  const copy = mkdtempSync(join(tmpdir(), "galewood-again-"));
  for (const name of readdirSync(data)) {
    if (name !== "cache" && !name.startsWith(".lock")) cpSync(join(data, name), join(copy, name), { recursive: true });
  }
  return copy;
}

test("the forest goes on while its server is away, and the stream comes back with it", async ({ page, quiet }) => {
  const source = process.env.SERVER_DATA;
  test.skip(!source, "the server of BASE_URL is not ours to stop");
  const data = copyOf(source ?? "");
  const port = await freePort();
  const base = `http://127.0.0.1:${port}`;
  const healthy = async () => (await fetch(`${base}/healthz`)).ok;
  const state = () => page.evaluate(() => window.galewood!.connection.state);
  let server = serve(port, data);
  try {
    await until("the server", STARTS_WITHIN_MS, healthy);
    await page.goto(`${base}/?${SMALL.replace("panel=0", "panel=1")}&speed=12&lookup=server`);
    await forest(page);
    await expect.poll(state).toBe("live");
    await expect(page.locator("#status")).toContainText(/Computed on the server, \d+ ms, frame \d+ ms old/);

    const killed_ms = Date.now();
    process.kill(-(server.pid ?? 0), "SIGKILL");
    await expect(page.locator("#status")).toContainText("computing in this browser");
    console.log(`the page said so after ${Date.now() - killed_ms} ms`);
    const time_s = await page.evaluate(() => window.galewood!.time_s);
    await page.waitForFunction((from) => window.galewood!.time_s > from + 3, time_s);
    expect(await sway_m(page)).toBeGreaterThan(0.01);

    server = serve(port, data);
    await until("the server's return", STARTS_WITHIN_MS, healthy);
    const returned_ms = Date.now();
    await expect.poll(state, { intervals: [100] }).toBe("live");
    await expect(page.locator("#status")).toContainText("Computed on the server");
    console.log(`the stream was back ${Date.now() - returned_ms} ms after the server`);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.01);
    // The browser itself logs what it could not reach.
    const own = quiet.splice(0).filter((text) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY|WebSocket connection/.test(text));
    expect(own).toEqual([]);
  } finally {
    await page.goto("about:blank"); // nobody is left to complain of the server's end
    await stop(server);
    rmSync(data, { recursive: true, force: true });
  }
});
