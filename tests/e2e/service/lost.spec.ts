import type { Route } from "@playwright/test";
import { rmSync } from "node:fs";
import { branchedTree } from "../branchedTree";
import { expect, forest, SMALL, test } from "../forest";
import { copyOf, freePort, serve, STARTS_WITHIN_MS, stop, until } from "../server";

test("what needs a server that is gone says so, keeps what the visitor did, and is done when tried again", { tag: "@long" }, async ({ page, context, quiet }) => {
  const source = process.env.SERVER_DATA;
  test.skip(!source, "the server of BASE_URL must not be stopped");
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.setViewportSize({ width: 1280, height: 720 });
  const data = copyOf(source ?? "");
  const port = await freePort();
  const base = `http://127.0.0.1:${port}`;
  const healthy = async () => (await fetch(`${base}/healthz`)).ok;
  let server = serve(port, data);
  const tool = (name: string) =>
    page.evaluate((label) => document.querySelector<HTMLButtonElement>(`[aria-label='${label}']`)?.click(), name);
  const said = (words: string) => page.locator(".toast").filter({ hasText: words });
  try {
    await until("the server", STARTS_WITHIN_MS, healthy);
    await page.goto(`${base}/?${SMALL.replace("panel=0", "panel=1")}&speed=3`);
    await forest(page);

    // The server dies while it reads an upload.
    const killing = async (route: Route) => {
      const ended = new Promise((done) => server.once("exit", done));
      process.kill(-(server.pid ?? 0), "SIGKILL");
      await ended;
      await route.continue();
    };
    await page.route("**/api/trees", killing, { times: 1 });
    await page.setInputFiles("#file", { name: "lost.obj", mimeType: "model/obj", buffer: Buffer.from(branchedTree()) });
    await expect(said("lost.obj was not uploaded; the page keeps it.")).toContainText("The server is not connected.");
    await tool("Share this forest");
    await expect(said("This forest is not shared.")).toContainText("The server is not connected.");
    await expect(page.locator(".sharing")).toBeHidden();
    await tool("Check accuracy");
    await expect(said("The accuracy was not checked.")).toContainText("The server is not connected.");
    // Still without a server: it is said again.
    await said("This forest is not shared.").getByRole("button", { name: "Try again" }).click();
    await expect(said("This forest is not shared.")).toBeVisible();

    server = serve(port, data);
    await until("the server's return", STARTS_WITHIN_MS, healthy);
    await said("This forest is not shared.").getByRole("button", { name: "Try again" }).click();
    await expect(page.locator(".sharing")).toContainText("Nobody else is here yet.");
    await said("The accuracy was not checked.").getByRole("button", { name: "Try again" }).click();
    const comparison = page.getByRole("dialog", { name: "Check accuracy" });
    await expect(comparison.getByRole("status")).not.toHaveText("");
    await expect(comparison).toHaveCSS("padding-left", "20px"); // its style sheet is there too
    await comparison.getByRole("button", { name: "Close" }).click();
    await said("lost.obj").getByRole("button", { name: "Try again" }).click();
    await expect(page.getByRole("button", { name: "Add to the forest" })).toBeEnabled();
    // The browser logs failed connections itself.
    const own = quiet.splice(0).filter((text) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY|WebSocket connection/.test(text));
    expect(own).toEqual([]);
  } finally {
    await page.goto("about:blank"); // so that the page does not log the end of the server
    await stop(server);
    rmSync(data, { recursive: true, force: true });
  }
});
