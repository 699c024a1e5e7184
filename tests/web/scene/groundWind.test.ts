/** The wind that grass bows in is that of the trees, place by place. */
import { meanVelocity_m_s, PRESETS, WindField } from "galewood/wind";
import { DataUtils } from "three";
import { describe, expect, it } from "vitest";
import { bladeLean_rad, GroundWind, grassLean_rad, sweepDown } from "../../../web/src/scene/ground/groundWind";
import { seededRandom } from "../seeded";

/** What a shader reads from the texture: linear between the four texels around a place. */
function sampled(wind: GroundWind, x: number, z: number): [number, number] {
  const { x: left, y: top, z: per_m } = wind.uniforms.uGroundLeanAt.value;
  const side = wind.uniforms.uGroundLean.value.image.width;
  const [u, v] = [(x - left) * per_m * side - 0.5, (z - top) * per_m * side - 0.5];
  const [column, row] = [Math.floor(u), Math.floor(v)];
  const [right, down] = [u - column, v - row];
  const at = (c: number, r: number, channel: number) =>
    DataUtils.fromHalfFloat(wind.data[2 * (r * side + c) + channel]);
  return [0, 1].map(
    (channel) =>
      (1 - right) * (1 - down) * at(column, row, channel) +
      right * (1 - down) * at(column + 1, row, channel) +
      (1 - right) * down * at(column, row + 1, channel) +
      right * down * at(column + 1, row + 1, channel),
  ) as [number, number];
}

/** The lean of grass in a wind, along it. */
function leaning(vx: number, vz: number): [number, number] {
  const speed = Math.hypot(vx, vz);
  return [(grassLean_rad(speed) * vx) / speed, (grassLean_rad(speed) * vz) / speed];
}

describe("wind at the ground", () => {
  it("is that of the trees: exact at its places, close between them, after the camera has moved too", () => {
    const random = seededRandom(5);
    const field = new WindField(PRESETS["storm-front"]);
    const wind = new GroundWind();
    const mean_m_s = meanVelocity_m_s(PRESETS["storm-front"]);
    const [vx, vz] = [new Float64Array(1), new Float64Array(1)];
    for (const [time_s, eye] of [
      [3, { x: 2, z: -7 }],
      [4.1, { x: 31.3, z: 12.8 }],
    ] as const) {
      wind.update(field, time_s, eye);
      let squares = 0;
      for (let k = 0; k < 200; k++) {
        const place = [eye.x + 80 * (random() - 0.5), eye.z + 80 * (random() - 0.5)];
        field.velocity([place[0]], [place[1]], field.at(time_s), vx, vz);
        sweepDown(mean_m_s, vx, vz);
        const [x, z] = sampled(wind, place[0], place[1]);
        const [leanX, leanZ] = leaning(vx[0], vz[0]);
        squares += (x - leanX) ** 2 + (z - leanZ) ** 2;
      }
      expect(Math.sqrt(squares / 200)).toBeLessThan(0.02);
      for (const i of [0, 100, 399]) {
        field.velocity([wind.x[i]], [wind.z[i]], field.at(time_s), vx, vz);
        sweepDown(mean_m_s, vx, vz);
        const [x, z] = sampled(wind, wind.x[i], wind.z[i]);
        const [leanX, leanZ] = leaning(vx[0], vz[0]);
        expect(Math.hypot(x - leanX, z - leanZ)).toBeLessThan(0.001);
      }
    }
  });

  it("bows grass a little in a breeze and lays it down in a storm", () => {
    const lean = [0, 4, 8, 18, 30].map(grassLean_rad);
    expect(lean[0]).toBe(0);
    for (let k = 1; k < lean.length; k++) expect(lean[k]).toBeGreaterThan(lean[k - 1]);
    expect(lean[1]).toBeGreaterThan(0.15);
    expect(lean[3]).toBeGreaterThan(1);
    expect(lean[4]).toBeLessThan(Math.PI / 2);
  });

  it("gusts reach the ground stronger than they are above, about the same mean", () => {
    const [vx, vz] = [Float64Array.of(14, 10, 6), Float64Array.of(3, 0, -3)];
    sweepDown({ x: 10, z: 0 }, vx, vz);
    expect(vx[0] - 10).toBeGreaterThan(4);
    expect(vz[0]).toBeGreaterThan(3);
    expect([vx[1], vz[1]]).toEqual([10, 0]);
    expect(vx[0] + vx[2]).toBeCloseTo(20, 12);
  });

  it("a blade whips the more the stronger the wind, stays above the ground, and is still in still air", () => {
    const spread = (strength: number) => {
      const leans = Array.from({ length: 400 }, (_, k) => bladeLean_rad(strength, 0.3, k / 30));
      expect(Math.max(...leans)).toBeLessThan(Math.PI / 2);
      return Math.max(...leans) - Math.min(...leans);
    };
    expect(spread(0)).toBe(0);
    expect(spread(0.9)).toBeGreaterThan(1.4 * spread(0.2));
  });
});
