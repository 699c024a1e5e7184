import { readFileSync } from "node:fs";
import AxeBuilder from "@axe-core/playwright";
import { PNG } from "pngjs";
import { background, changedPixels, expect, forest, frames, open, type Picture, picture, SMALL, sway_m, test } from "../forest";

const still = `${SMALL}&speed=0`;
const panelled = still.replace("panel=0", "panel=1");

/** Pictures after which what is around the trees, which appears thing by thing, and the shadows are all shown. */
const ALL_SHOWN_FRAMES = 15;

/** Mean of each channel over the upper part of a picture: the sky. */
function skyColour({ width, height, data }: Picture): [number, number, number] {
  const sum: [number, number, number] = [0, 0, 0];
  const pixels = width * Math.floor(height * 0.2);
  for (let i = 0; i < pixels * 4; i += 4) for (let c = 0; c < 3; c++) sum[c] += data[i + c] / pixels;
  return sum;
}

const share = (a: Picture, b: Picture, tolerance: number) => changedPixels(a, b, tolerance) / (a.width * a.height);

test.describe("pictures", () => {
  test.use({ deviceScaleFactor: 0.5, drawn: "always" });

  test("every season and the evening look different", { tag: "@long" }, async ({ page }) => {
    await open(page, still);
    await forest(page);
    await background(page);
    const scene = async (season: string, daytime: number) => {
      await page.evaluate(
        async ([name, time]) => {
          const galewood = window.galewood!;
          galewood.sleep(true);
          galewood.dress(name as never, time as number);
          for (let k = 0; k < 10; k++) await galewood.step(0.5); // exposure and clouds adapt
        },
        [season, daytime],
      );
      return picture(page);
    };
    const noon = await scene("summer", 0.5);
    const evening = await scene("summer", 0.97);
    const others = [await scene("spring", 0.5), await scene("autumn", 0.5), await scene("winter", 0.5)];
    for (const other of others) expect(share(noon, other, 16)).toBeGreaterThan(0.15);
    expect(share(others[1], others[2], 16)).toBeGreaterThan(0.3);
    const [red, , blue] = skyColour(noon);
    const [eveningRed, , eveningBlue] = skyColour(evening);
    expect(blue).toBeGreaterThan(1.2 * red);
    expect(eveningRed / eveningBlue).toBeGreaterThan((1.2 * red) / blue);
    // The first scene again, up to what is left of the adaptation.
    expect(share(noon, await scene("summer", 0.5), 8)).toBeLessThan(0.02);
  });

  test("a night in a storm is moonlit, not black", { tag: "@long" }, async ({ page }) => {
    await open(page, `${SMALL}&speed=20&season=summer&time=1.2`);
    await forest(page);
    const { data } = await picture(page);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum += 0.2126 * data[i] + 0.7152 * data[i + 1] + 0.0722 * data[i + 2];
    const mean = sum / (data.length / 4);
    console.log(`mean luminance ${mean.toFixed(0)} of 255`);
    expect(mean).toBeGreaterThan(25);
    expect(mean).toBeLessThan(130);
  });

  test("at high quality the light of the sky is occluded among trees, and the sky itself is not", { tag: "@long" }, async ({ page }) => {
    const shown = async (quality: string) => {
      await open(page, still.replace("quality=low", `quality=${quality}`));
      await forest(page);
      await frames(page, ALL_SHOWN_FRAMES);
      return picture(page);
    };
    const [medium, high] = [await shown("medium"), await shown("high")];
    // The lower third, ground and stems: leaves differ between the levels of detail of both.
    const light = ({ data }: Picture) => {
      const low = data.slice(4 * Math.floor(data.length / 6));
      return low.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / (0.75 * low.length);
    };
    console.log(`mean light: medium ${light(medium).toFixed(1)}, high ${light(high).toFixed(1)} of 255`);
    expect(light(high)).toBeLessThan(light(medium));
    expect(light(high)).toBeGreaterThan(0.7 * light(medium));
    // The corner of the sky that no tree reaches.
    for (let y = 0; y < 8; y++) {
      for (let i = 4 * y * high.width; i < 4 * (y * high.width + 8); i++) {
        const before = medium.data[4 * y * medium.width + (i - 4 * y * high.width)];
        expect(Math.abs(high.data[i] - before)).toBeLessThan(8);
      }
    }
  });

  test("leaves close to the eye are drawn one by one", { tag: "@long" }, async ({ page }) => {
    await open(page, "panel=0&quality=medium&trees=6&background=0&season=summer&speed=4");
    await forest(page);
    await frames(page, ALL_SHOWN_FRAMES);
    const counts = await page.evaluate(async () => {
      const galewood = window.galewood!;
      galewood.sleep(true);
      const columns = Array.from({ length: 30 }, (_, k) => (innerWidth * (k + 0.5)) / 30);
      const tree = columns.map((x) => galewood.pick(x, 0.4 * innerHeight)).find((picked) => picked !== null);
      if (!tree) throw new Error("no tree in view");
      const { position: { x, z }, height_m, radius_m } = tree;
      const above = 0.5 * height_m;
      const shown = async (away_m: number) => {
        galewood.look({ x, above, z: z + away_m }, { x, above, z });
        for (let k = 0; k < 4; k++) await galewood.step(0.1);
        return galewood.statistics.triangles;
      };
      const beside_m = radius_m + 5; // its sprays are all drawn, too
      return [await shown(beside_m), await shown(0.7 * radius_m), await shown(beside_m)];
    });
    console.log(JSON.stringify(counts));
    const [beside, inside, besideAgain] = counts;
    expect(inside).toBeGreaterThan(beside + 100_000);
    expect(besideAgain).toBe(beside);
  });

  test("a shared link restores the picture", async ({ page, context }) => {
    await page.setViewportSize({ width: 480, height: 270 });
    await context.grantPermissions(["clipboard-read", "clipboard-write"]);
    await open(page, `${panelled}&season=winter&time=0.8&forest=11`);
    await forest(page);
    await page.evaluate(() => window.galewood!.look({ x: -6, above: 5, z: 12 }, { x: 2, above: 5, z: -20 }));
    await page.evaluate(() => document.querySelector<HTMLButtonElement>("[aria-label='Copy link']")?.click());
    await expect(page.getByRole("alert")).toContainText("Link copied");
    const link = await page.evaluate(() => navigator.clipboard.readText());
    const bare = async () => {
      await page.addStyleTag({ content: "body > :not(main) { visibility: hidden !important }" });
      await frames(page, ALL_SHOWN_FRAMES);
      return picture(page);
    };
    const before = await bare();
    await page.goto("about:blank");
    await page.goto(link);
    await forest(page);
    const after = await bare();
    // Camera damping may leave a tiny difference.
    expect(share(before, after, 24)).toBeLessThan(0.01);
  });
});

for (const lookup of ["worker", "server"] as const) {
  test(`in winter trees move by their tables without leaves, and by the others again (${lookup})`, { tag: lookup === "server" ? "@long" : [] }, async ({ page }) => {
    const { trees } = (await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).json()) as {
      trees: { builtin: boolean; bare_table_sha256: string | null }[];
    };
    const bare = trees.filter((tree) => tree.builtin).every((tree) => tree.bare_table_sha256 !== null);
    test.skip(!bare, "a built-in tree is shipped without such a table");
    const fetched: string[] = [];
    page.on("request", (request) => fetched.push(request.url()));
    const asked = (tree: { bare_table_sha256: string | null }) =>
      fetched.some((url) => url.endsWith(`/api/tables/${tree.bare_table_sha256}`));
    await open(page, `${SMALL}&speed=6&season=autumn&lookup=${lookup}`);
    await forest(page);
    expect(trees.some(asked)).toBe(false);
    const bareTrees = () => page.evaluate(() => window.galewood!.bareTrees);
    const dress = (season: string) => page.evaluate((name) => window.galewood!.dress(name as never, 0.5), season);
    expect(await bareTrees()).toBe(0);
    await dress("winter");
    await expect.poll(bareTrees).toBe(await page.evaluate(() => window.galewood!.trees.moving));
    if (lookup === "server")
      await expect.poll(() => page.evaluate(() => window.galewood!.connection.state)).toBe("live");
    await expect.poll(() => sway_m(page)).toBeGreaterThan(1e-3);
    await dress("spring");
    await expect.poll(bareTrees).toBe(0);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(1e-3);
  });
}

test("a forest is shared by a winter computed here and a winter streamed by the server", { tag: "@long" }, async ({ page, context }) => {
  const { trees } = (await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).json()) as {
    trees: { builtin: boolean; bare_table_sha256: string | null }[];
  };
  const bare = trees.filter((tree) => tree.builtin).every((tree) => tree.bare_table_sha256 !== null);
  test.skip(!bare, "a built-in tree is shipped without such a table");
  const shared = `${SMALL}&speed=6&season=winter&share=winter-${Date.now()}`;
  await open(page, shared);
  await expect.poll(() => page.evaluate(() => window.galewood?.bareTrees ?? 0)).toBeGreaterThan(0);
  await expect.poll(() => page.evaluate(() => window.galewood!.connection.state)).toBe("live");
  const other = await context.newPage();
  await open(other, `${shared}&lookup=server`);
  await forest(other);
  await expect.poll(() => other.evaluate(() => window.galewood!.connection.state)).toBe("live");
  await expect.poll(() => sway_m(other)).toBeGreaterThan(1e-3);
  expect(await other.evaluate(() => window.galewood!.bareTrees)).toBe(0);
  await other.close();
});

test("without WebGL a card explains why there is no forest, and shows a film of it", async ({ page }) => {
  await page.addInitScript(() => {
    const context = HTMLCanvasElement.prototype.getContext as (kind: string, ...more: unknown[]) => RenderingContext | null;
    HTMLCanvasElement.prototype.getContext = function none(this: HTMLCanvasElement, kind: string, ...more: unknown[]) {
      return kind === "webgl2" ? null : context.call(this, kind, ...more);
    } as typeof HTMLCanvasElement.prototype.getContext;
  });
  await open(page, "");
  const card = page.getByRole("region", { name: "This browser cannot draw the forest" });
  await expect(card).toContainText("hardware acceleration");
  const width_px = () => card.getByRole("img").evaluate((film: HTMLImageElement) => film.naturalWidth);
  await expect.poll(width_px).toBeGreaterThan(100);
  await expect(page.locator("#hud")).toBeHidden();
});

test("the first trees take one graphics context and one shader of moving leaves, which is compiled before their mesh is there", async ({ page }) => {
  await page.addInitScript(() => {
    const made = { contexts: new Set<unknown>(), leaves: 0 };
    Object.assign(window, { made });
    const getContext = HTMLCanvasElement.prototype.getContext as (...args: unknown[]) => unknown;
    HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, ...args: unknown[]) {
      const context = getContext.apply(this, args);
      if (args[0] === "webgl2") made.contexts.add(context);
      return context as never;
    };
    const { shaderSource } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.shaderSource = function (shader, source) {
      if (source.includes("leafCover(") && source.includes("flashHz")) made.leaves++;
      shaderSource.call(this, shader, source);
    };
  });
  const made = () =>
    page.evaluate(() => {
      const { contexts, leaves } = (window as unknown as { made: { contexts: Set<unknown>; leaves: number } }).made;
      return { contexts: contexts.size, leaves };
    });
  const meshes: unknown[] = [];
  await page.route("**/api/light-meshes/*", async (route) => {
    if (meshes.length === 0) await expect.poll(made).toEqual({ contexts: 1, leaves: 1 });
    meshes.push(route.request().url());
    await route.continue();
  });
  await open(page, SMALL.replace("&quality=low", ""));
  await forest(page);
  expect(meshes.length).toBeGreaterThan(0);
  expect(await made()).toEqual({ contexts: 1, leaves: 1 });
});

test("settings persist between visits", async ({ page }) => {
  await open(page, "quality=low&trees=5&speed=0&background=0");
  await forest(page);
  await page.getByRole("button", { name: "Summer" }).click();
  await page.goto(`${process.env.BASE_URL}/`);
  await forest(page);
  await expect(page.getByRole("button", { name: "Summer" })).toHaveAttribute("aria-pressed", "true");
  expect(await page.evaluate(() => window.galewood!.trees.moving)).toBeLessThanOrEqual(5);
});

test.describe("on a wide page", () => {
  // Low resolution because of software rendering.
  test.use({ deviceScaleFactor: 0.5 });

  for (const [name, width, height] of [["a desk", 1100, 640], ["a phone", 390, 760]] as const) {
    test(`no serious accessibility violation on ${name}`, { tag: width < 760 ? "@long" : [] }, async ({ page }) => {
      await page.setViewportSize({ width, height });
      await open(page, "quality=low&trees=2&speed=0");
      await forest(page);
      // Stop drawing: the audit needs only the controls, and the processor.
      await page.evaluate(() => window.galewood!.sleep(true));
      const faults = async () => {
        const { violations } = await new AxeBuilder({ page }).analyze();
        return violations
          .filter(({ impact }) => impact === "serious" || impact === "critical")
          .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(" | ")}`);
      };
      expect(await faults()).toEqual([]);
      await page.getByRole("button", { name: "Settings" }).click();
      expect(await faults()).toEqual([]);
      await page.getByRole("button", { name: "Settings" }).click();
      await page.getByRole("button", { name: "About" }).click();
      await expect(page.getByRole("dialog", { name: "About Galewood" })).toContainText("full simulation");
      expect(await faults()).toEqual([]);
      await page.keyboard.press("Escape");
      if (width < 760) await page.getByRole("button", { name: "Tools" }).click();
      await page.getByRole("button", { name: "Tree physics" }).click();
      await expect(page.getByRole("dialog")).toContainText("First natural frequency");
      expect(await faults()).toEqual([]);
      await page.keyboard.press("Escape");
      await expect(page.getByRole("dialog")).toBeHidden();
    });
  }

  test.describe("pictures of it", () => {
    test.use({ deviceScaleFactor: 0.25, drawn: "always" });

    test("tools: view, fly-through, photo, video", { tag: "@long" }, async ({ page }) => {
      await page.setViewportSize({ width: 800, height: 300 });
      await open(page, "quality=low&trees=2&speed=5&background=0");
      await forest(page);
      const eye = () => page.evaluate(() => window.galewood!.eye);
      const first = await eye();
      await page.getByRole("button", { name: "Tools" }).click();
      await page.getByRole("button", { name: "Views" }).click();
      await page.getByRole("button", { name: "Above the canopy" }).click();
      await expect.poll(async () => (await eye())[1]).toBeGreaterThan(first[1] + 8);
      const fly = page.getByRole("button", { name: "Fly through the forest" });
      await fly.click();
      const begun = await eye();
      await expect.poll(async () => Math.hypot(...(await eye()).map((at, k) => at - begun[k]))).toBeGreaterThan(1);
      await fly.click();
      await expect(fly).toHaveAttribute("aria-pressed", "false");
      const photo = page.waitForEvent("download");
      await page.getByRole("button", { name: "Save photo" }).click();
      expect((await photo).suggestedFilename()).toMatch(/^galewood-.*\.png$/);
      // all pixels of the screen, though low quality draws fewer
      const { width, height } = PNG.sync.read(readFileSync(await (await photo).path()));
      expect([width, height]).toEqual([200, 75]);
      const film = page.getByRole("button", { name: "Record video" });
      await film.click();
      await expect(film).toHaveAttribute("aria-pressed", "true");
      await frames(page, 6);
      const saved = page.waitForEvent("download");
      await film.click();
      expect((await saved).suggestedFilename()).toMatch(/^galewood-.*\.webm$/);
    });
  });
});
