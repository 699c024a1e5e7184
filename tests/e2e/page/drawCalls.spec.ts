import { background, changedPixels, elapse, expect, forest, frames, open, picture, SMALL, test } from "../forest";

/** Of ground, sky, plants and their shadows. */
const LAND_CALLS = 32;
/** Of each form of a species, with its shadows and its trees far away. */
const FORM_CALLS = 13;
/** By then trees in a steady wind stand still, s. */
const SETTLED_S = 40;
/** The built-in poplar, open-grown and forest-grown. */
const FORMS = 2;

for (const quality of ["low", "medium"]) {
  test(`a forest of 1,000 trees takes few draw calls at ${quality} quality`, async ({ page }) => {
    await open(page, `panel=0&quality=${quality}&trees=1000&flutter=0`);
    await forest(page);
    await background(page);
    await frames(page, 2);
    const calls = await page.evaluate(() => window.galewood!.statistics.drawCalls);
    expect(calls).toBeGreaterThan(0);
    expect(calls).toBeLessThanOrEqual(LAND_CALLS + FORMS * FORM_CALLS);
  });
}

test.describe("without calls of several draws", () => {
  test.use({ drawn: "always" });

  test("the same picture takes more calls", async ({ page }) => {
    const time_s = () => page.evaluate(() => window.galewood!.time_s);
    const shown = async () => {
      await open(page, `${SMALL}&trees=12&speed=12&gust=0`);
      await forest(page);
      await elapse(page, SETTLED_S - (await time_s())); // in a steady wind, until the trees stand bent
      await page.evaluate(async (end_s) => {
        window.galewood!.sleep(true);
        await window.galewood!.step(Math.max(1e-4, end_s - window.galewood!.time_s));
      }, SETTLED_S + 1); // the same time, at which clouds and grass are the same
      return [await picture(page), await page.evaluate(() => window.galewood!.statistics.drawCalls)] as const;
    };
    const [together, fewCalls] = await shown();
    await page.addInitScript(() => {
      const graphics = WebGL2RenderingContext.prototype;
      const { getExtension, getSupportedExtensions } = graphics;
      const hidden = "WEBGL_multi_draw";
      graphics.getExtension = function get(this: WebGL2RenderingContext, name: string) {
        return name === hidden ? null : getExtension.call(this, name as never);
      } as typeof getExtension;
      graphics.getSupportedExtensions = function names() {
        return getSupportedExtensions.call(this)?.filter((name) => name !== hidden) ?? null;
      };
    });
    const [apart, manyCalls] = await shown();
    expect(manyCalls).toBeGreaterThan(fewCalls);
    // Leaves in the air differ, and the ground while it is painted.
    expect(changedPixels(together, apart, 40)).toBeLessThan(0.03 * together.width * together.height);
  });
});
