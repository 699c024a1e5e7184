import type { Page } from "@playwright/test";
import { CALM_BREEZE } from "../../../web/player/src/core/wind/presets";
import { elapse, expect, forest, open, SMALL, test } from "../forest";

const panelled = SMALL.replace("panel=0", "panel=1");
/** Large enough for the instruments, at a low resolution because of software rendering. */
const wide = { viewport: { width: 800, height: 600 }, deviceScaleFactor: 0.4 };
const link = (wind: unknown) => `wind=${encodeURIComponent(JSON.stringify(wind))}`;
const steady = { ...CALM_BREEZE, mean_speed_m_s: 5, gustiness: 0 };

/** Share of the mean crown displacement that is along a heading. */
const lean = (heading_deg: number) => {
  const [x, , z] = window.galewood!.crownDisplacement_m;
  const c = Math.cos((heading_deg * Math.PI) / 180);
  const s = Math.sin((heading_deg * Math.PI) / 180);
  return (c * x + s * z) / Math.max(1e-9, Math.hypot(x, z));
};

/** Presses the mouse at the centre of the dial; returns the centre, and a distance (px) that gives more than 4 m/s. */
async function takeArrow(page: Page) {
  const rose = page.locator(".rose");
  let box = await rose.boundingBox();
  // repeat if the layout has shifted meanwhile, for example because of a progress card
  await expect(async () => {
    await page.mouse.up();
    box = await rose.boundingBox();
    await page.mouse.move(box!.x + box!.width / 2, box!.y + box!.height / 2);
    await page.mouse.down();
    expect(await rose.boundingBox()).toEqual(box);
  }).toPass();
  const { x, y, width, height } = box!;
  return { centre: { x: x + width / 2, y: y + height / 2 }, reach: 0.18 * width };
}

test.describe("the rose", () => {
  test.use(wide);

  for (const lookup of ["worker", "server"]) test(`trees bend in the direction of the dragged arrow (${lookup})`, { tag: lookup === "server" ? "@long" : [] }, async ({ page }) => {
    await open(page, `${panelled}&lookup=${lookup}&${link(steady)}`);
    await forest(page);
    const directions: number[] = [];
    for (const [right, down] of [[1, 0], [-0.7, 0.7]]) {
      const { centre, reach } = await takeArrow(page);
      await page.mouse.move(centre.x + reach * right, centre.y + reach * down, { steps: 4 });
      await page.mouse.up();
      const { direction_deg, mean_speed_m_s } = await page.evaluate(() => window.galewood!.wind);
      expect(mean_speed_m_s).toBeGreaterThan(4);
      await expect.poll(() => page.evaluate(lean, direction_deg)).toBeGreaterThan(0.8);
      expect(new URL(page.url()).searchParams.get("wind")).toContain(`"direction_deg":${direction_deg}`);
      directions.push(direction_deg);
    }
    const turned = (directions[1] - directions[0] + 360) % 360;
    expect(Math.abs(turned - 135)).toBeLessThan(4);
  });

  test("a layout shift during a drag does not change the wind", async ({ page }) => {
    await open(page, `${panelled}&${link(steady)}`);
    await forest(page);
    const rose = page.locator(".rose");
    const box = await rose.boundingBox();
    if (!box) throw new Error("no rose");
    const end = { x: box.x + 0.7 * box.width, y: box.y + 0.5 * box.height };
    await page.mouse.move(end.x, end.y);
    await page.mouse.down();
    const before = await page.evaluate(() => window.galewood!.wind);
    await rose.evaluate((dial) => {
      const card = document.createElement("div");
      card.style.height = "60px";
      dial.before(card);
    });
    await expect.poll(async () => (await rose.boundingBox())!.y).toBeGreaterThan(box.y + 30);
    await page.mouse.move(end.x + 1, end.y);
    const after = await page.evaluate(() => window.galewood!.wind);
    await page.mouse.up();
    expect(after.direction_deg).toBe(before.direction_deg);
    expect(Math.abs(after.mean_speed_m_s - before.mean_speed_m_s)).toBeLessThan(2); // a pixel; the shift would be 20
  });

  test("the arrow can be moved with the keyboard and describes the wind", async ({ page }) => {
    await open(page, `${panelled}&${link(steady)}`);
    await forest(page);
    const arrow = page.getByRole("slider", { name: "Wind", exact: true });
    await arrow.focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("PageUp");
    expect(await page.evaluate(() => window.galewood!.wind)).toMatchObject({ direction_deg: 35, mean_speed_m_s: 8 });
    await expect(arrow).toHaveAttribute("aria-valuetext", /^North-westerly, 8 m\/s: fresh breeze \(Beaufort 5\)$/);
  });
});

test("the wind of a link is used; an invalid one is rejected with path and range", async ({ page }) => {
  const wind = { ...steady, model: "perlin", length_scale_m: 33, seed: 5 };
  await open(page, `${SMALL}&${link(wind)}`);
  await forest(page);
  expect(await page.evaluate(() => window.galewood!.wind)).toEqual(wind);
  await open(page, `${panelled}&${link({ ...wind, length_scale_m: 3 })}`);
  await expect(page.getByRole("alert")).toContainText("wind.length_scale_m: expected a number in 5..200, not 3");
});

test("page and REST reject an invalid wind with the same message", async ({ page, request }) => {
  await open(page, `${panelled}&${link(steady)}`);
  await forest(page);
  const bad = { ...steady, gustiness: 7 };
  const words = "wind.gustiness: expected a number in 0..1, not 7";
  const thrown = await page.evaluate((wind) => {
    try {
      window.galewood!.setWind(wind);
    } catch (error) {
      return String(error);
    }
  }, bad);
  expect(thrown).toContain(words);
  await page.setInputFiles('[data-testid="wind-file"]', {
    name: "wind.json",
    mimeType: "application/json",
    buffer: Buffer.from(JSON.stringify(bad)),
  });
  await expect(page.getByRole("alert")).toContainText(words);
  const answer = await request.post(`${process.env.BASE_URL}/api/winds/validate`, { data: bad });
  expect(answer.status()).toBe(422);
  expect((await answer.json()).detail).toBe(words);
  expect(await page.evaluate(() => window.galewood!.wind)).toMatchObject(steady);
});

test.describe("the anemometer", () => {
  test.use(wide);

  test("is placed by a click on the ground and measures there", async ({ page }) => {
    await open(page, `${panelled}&${link({ ...steady, gustiness: 0.5 })}`);
    await forest(page);
    await page.getByRole("button", { name: "Anemometer" }).click();
    await page.mouse.click(560, 480);
    await expect.poll(() => page.evaluate(() => window.galewood!.anemometer)).not.toBeNull();
    await elapse(page, 12);
    expect(await page.evaluate(() => window.galewood!.anemometer!.samples)).toBeGreaterThan(100);
    await expect(page.locator(".plots canvas")).toHaveCount(2);
    const { speed_m_s, tip_m } = await page.evaluate(() => window.galewood!.anemometer!);
    expect(speed_m_s).toBeGreaterThan(2.5);
    expect(speed_m_s).toBeLessThan(7.5);
    expect(tip_m).toBeGreaterThan(0.01);
  });
});

test.describe("presets", () => {
  test.use(wide);

  /** Root mean square of the mean crown displacement about its mean, m, from 3 s to 20 s of the forest's time. */
  async function sway(page: Page): Promise<number> {
    await elapse(page, 3);
    const { crowns_m: track } = await elapse(page, 17);
    const mean = [0, 1, 2].map((axis) => track.reduce((sum, at) => sum + at[axis], 0) / track.length);
    const square = track.reduce((sum, at) => sum + at.reduce((all, x, axis) => all + (x - mean[axis]) ** 2, 0), 0);
    return Math.sqrt(square / track.length);
  }

  test("a storm moves the trees more than a breeze", { tag: "@long" }, async ({ page }) => {
    await open(page, panelled);
    await forest(page);
    const moved: number[] = [];
    for (const name of ["Breeze", "Storm front"]) {
      await page.getByRole("button", { name, exact: true }).click();
      moved.push(await sway(page));
    }
    expect(moved[1]).toBeGreaterThan(2 * moved[0]);
  });
});
