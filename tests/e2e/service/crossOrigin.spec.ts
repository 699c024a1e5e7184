/** A page of another origin: reads meshes, tables and the socket where the operator allows it, and nowhere else. */
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, test } from "../forest";
import { freePort, serve, STARTS_WITHIN_MS, stop, until } from "../server";

/** An empty page on an origin of its own. */
async function elsewhere(): Promise<{ server: Server; origin: string }> {
  const server = createServer((_, answer) => answer.setHeader("content-type", "text/html").end("<!doctype html>"));
  await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
  return { server, origin: `http://127.0.0.1:${(server.address() as AddressInfo).port}` };
}

/** What a page can get from the service: sizes of mesh and table, and whether the socket opens. */
async function taken(base: string): Promise<{ mesh: number; table: number; socket: boolean }> {
  const { trees } = await (await fetch(`${base}/api/trees`)).json();
  const tree = trees.find((one: { table_sha256: string | null }) => one.table_sha256);
  const bytes = async (path: string) => (await (await fetch(`${base}${path}`)).arrayBuffer()).byteLength;
  const socket = new WebSocket(`${base.replace("http", "ws")}/ws/forest`);
  const opened = await new Promise<boolean>((done) => {
    socket.onopen = () => done(true);
    socket.onerror = () => done(false);
  });
  socket.close();
  const mesh = await bytes(`/api/meshes/${tree.mesh_sha256}`);
  return { mesh, table: await bytes(`/api/tables/${tree.table_sha256}`), socket: opened };
}

test("an allowed origin takes mesh, table and socket; another one takes nothing", { tag: "@long" }, async ({ page, context }) => {
  const [friend, stranger] = [await elsewhere(), await elsewhere()];
  const port = await freePort();
  const base = `http://127.0.0.1:${port}`;
  const data = mkdtempSync(join(tmpdir(), "galewood-origins-"));
  const server = serve(port, data, { GALEWOOD_ALLOWED_ORIGINS: JSON.stringify([friend.origin]) });
  try {
    await until("the server", STARTS_WITHIN_MS, async () => {
      const { trees } = (await (await fetch(`${base}/api/trees`)).json()) as { trees: { table_sha256: string | null }[] };
      return trees.some((tree) => tree.table_sha256);
    });
    await page.goto(friend.origin);
    const got = await page.evaluate(taken, base);
    expect(got.mesh).toBeGreaterThan(10_000);
    expect(got.table).toBeGreaterThan(100_000);
    expect(got.socket).toBe(true);

    const other = await context.newPage();
    await other.goto(stranger.origin);
    expect(await other.evaluate((at) => fetch(`${at}/api/trees`).then(() => "read", () => "refused"), base)).toBe("refused");
    const opens = (at: string) =>
      new Promise<boolean>((done) => {
        const socket = new WebSocket(`${at.replace("http", "ws")}/ws/forest`);
        socket.onopen = () => done(true);
        socket.onerror = () => done(false);
      });
    expect(await other.evaluate(opens, base)).toBe(false);
    await other.close();
  } finally {
    await stop(server);
    for (const { server: one } of [friend, stranger]) one.close();
  }
});
