/** The exposure of the pictures before and after the camera is moved, and the edges of shadows. */
import { PerspectiveCamera, ShaderChunk, Vector3 } from "three";
import { expect, test } from "vitest";
import type { Daylight } from "../../../web/src/scene/sky/daylight";
import { Lighting } from "../../../web/src/scene/sky/lighting";
import { steadyShadows } from "../../../web/src/scene/sky/steadyShadows";
import type { Sky } from "../../../web/src/scene/sky/sky";

const NOON_SUN = new Vector3(0.2, 0.9, 0.1).normalize();

/** A camera that looks towards the horizon from this height, m. */
function cameraAt(height_m: number): PerspectiveCamera {
  const camera = new PerspectiveCamera(46, 16 / 9);
  camera.position.set(0, height_m, 0);
  camera.lookAt(100, height_m, 0);
  camera.updateMatrixWorld();
  return camera;
}

test("after a cut the exposure suits the new place at once, otherwise it eases", () => {
  const lighting = new Lighting({} as Sky, { towardsSun: NOON_SUN } as Daylight);
  const [high, low] = [cameraAt(700), cameraAt(2)];
  const there = lighting.expose(0, high);
  for (let k = 0; k < 20; k++) expect(lighting.expose(0, low)).toBe(there);
  lighting.adaptAtOnce();
  const here = lighting.expose(0, low);
  expect(here).toBeGreaterThan(1.1 * there);
  expect(lighting.expose(10, low)).toBe(here);
});

test("below closed clouds the eye adapts to the shade of crowns in the evening, too", () => {
  const low = new Vector3(0.6, 0.1, 0.6).normalize();
  const sky = { advance: () => {}, behindCloud: () => 0, show: () => {} } as unknown as Sky;
  const daylight = { towardsSun: low, show: () => {} } as unknown as Daylight;
  const crowns = Float32Array.from([-12, 0, 12, 24].flatMap((z) => [12, 9, z, 8, 9, 0.1, 0.2, 0.05, 1]));
  /** Exposure beside the crowns relative to that in the open. */
  const adapted = (wind_m_s: number) => {
    const lighting = new Lighting(sky, daylight);
    lighting.choose(0.95, "summer");
    lighting.advance(0, { x: wind_m_s, z: 0 });
    const open = lighting.expose(0, cameraAt(2));
    lighting.crowns = crowns;
    lighting.adaptAtOnce();
    return lighting.expose(0, cameraAt(2)) / open;
  };
  expect(adapted(0)).toBeGreaterThan(1);
  expect(adapted(22)).toBeGreaterThan(1.1 * adapted(0));
});

test("shadows are read at the same places in every pixel", () => {
  // three.js names the function that turns them; another release may write it differently
  const noise = /float interleavedGradientNoise\( vec2 position \) \{\s*return ([^;]*);/;
  const of = () => noise.exec(ShaderChunk.shadowmap_pars_fragment)?.[1];
  expect(of()).toContain("position");
  steadyShadows();
  steadyShadows();
  expect(of()).toBe("0.3");
});
