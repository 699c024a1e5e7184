import { rmSync } from "node:fs";
import { expect, forest, SMALL, sway_m, test } from "../forest";
import { copyOf, freePort, serve, STARTS_WITHIN_MS, stop, until } from "../server";

test("the forest keeps moving while the server is down, and the stream resumes with it", async ({ page, quiet }) => {
  const source = process.env.SERVER_DATA;
  test.skip(!source, "the server of BASE_URL must not be stopped");
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
    await expect(page.getByRole("button", { name: "Try now" })).toBeVisible();
    console.log(`the page reported it after ${Date.now() - killed_ms} ms`);
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
    // The browser logs failed connections itself.
    const own = quiet.splice(0).filter((text) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY|WebSocket connection/.test(text));
    expect(own).toEqual([]);
  } finally {
    await page.goto("about:blank"); // so that the page does not log the end of the server
    await stop(server);
    rmSync(data, { recursive: true, force: true });
  }
});
