/** Cost of the package's trees against the same trees drawn by three.js alone: still, and with morph targets. */
import { join } from "node:path";
import type { Browser, Page } from "@playwright/test";
import { site } from "../../../tests/e2e/player/examples";
import { processor_ms } from "./frames";
import { type Figure, median } from "./report";

/** Ways of drawing the same trees. */
const DRAWN_WAYS = ["package", "still", "morphed"] as const;
type Way = (typeof DRAWN_WAYS)[number];
const ROUND_COUNT = 5;
const BLOCK_FRAMES = 2;

interface Drawing {
  prepare(trees: number): Promise<{ trees: number; triangles: number }>;
  draw(way: Way, count: number): Promise<number>;
}

const drawing = (page: Page, way: Way) =>
  page.evaluate(
    ([one, count]) => (window as unknown as Drawing).draw(one as Way, Number(count)),
    [way, BLOCK_FRAMES],
  );

export async function measureRivals(browser: Browser, trees: number): Promise<Figure[]> {
  const served = await site(join(import.meta.dirname, "rivals"));
  const page = await browser.newPage();
  try {
    await page.goto(served.base);
    await page.waitForFunction(() => "prepare" in window);
    const seen = await page.evaluate((count) => (window as unknown as Drawing).prepare(count), trees);
    const session = await browser.newBrowserCDPSession();
    const frame: Record<Way, number[]> = { package: [], still: [], morphed: [] };
    const used: Record<Way, number[]> = { package: [], still: [], morphed: [] };
    for (let round = 0; round < ROUND_COUNT; round++) {
      for (const way of DRAWN_WAYS) {
        const before_ms = await processor_ms(session);
        frame[way].push(await drawing(page, way));
        used[way].push(((await processor_ms(session)) - before_ms) / BLOCK_FRAMES);
      }
    }
    const name = `${trees.toLocaleString("en")} trees of the package: `;
    const ratio = (of: Record<Way, number[]>, rival: Way) =>
      of.package.map((value, round) => value / of[rival][round]);
    const figure = (what: string, all: number[], unit = ""): Figure => ({
      name: name + what,
      value: median(all),
      unit,
      all,
    });
    return [
      figure("frame / InstancedMesh, still", ratio(frame, "still")),
      figure("frame / InstancedMesh, two morph targets", ratio(frame, "morphed")),
      figure("processor time / InstancedMesh, still", ratio(used, "still")),
      figure("processor time / InstancedMesh, two morph targets", ratio(used, "morphed")),
      figure("frame", frame.package, "ms"),
      figure("trees in view", [seen.trees]),
      figure("triangles in view", [seen.triangles]),
    ];
  } finally {
    await page.close();
    served.close();
  }
}
