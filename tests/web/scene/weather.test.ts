import { describe, expect, it } from "vitest";
import { PRESETS } from "../../../web/player/src/core/wind/presets";
import { SEASON_LOOKS, SEASONS } from "../../../web/src/scene/season/season";
import { behindCloud, cloudBody, cloudEdge } from "../../../web/src/scene/sky/cloudField";
import { atmosphereAt, underClouds } from "../../../web/src/scene/sky/daytime";
import {
  CROWN_FLOATS,
  crownDistance,
  crownsNear,
  easeGain,
  type Gaze,
  gainFor,
  MOST_GAIN,
  NEAR_M,
  viewLight,
} from "../../../web/src/scene/sky/exposure";
import { belowClouds, easeWeather, overcastRadiance, weatherFor } from "../../../web/src/scene/sky/weather";
import { paintNoise } from "../../../web/src/scene/textures/paint";

const sum = (light: readonly number[]) => light[0] + light[1] + light[2];

describe("clouds follow the wind", () => {
  it("covers more of the sky and darkens as the wind grows", () => {
    for (const season of SEASONS) {
      const fair = SEASON_LOOKS[season].clouds;
      const winds = Array.from({ length: 61 }, (_, speed) => weatherFor(speed, fair));
      for (let k = 1; k < winds.length; k++) {
        expect(winds[k].cover).toBeGreaterThanOrEqual(winds[k - 1].cover);
        expect(winds[k].dark).toBeGreaterThanOrEqual(winds[k - 1].dark);
      }
      const of = (name: keyof typeof PRESETS) => weatherFor(PRESETS[name].mean_speed_m_s, fair);
      expect(of("still").cover).toBe(fair);
      expect(of("breeze").cover).toBeLessThan(0.5);
      expect(of("autumn-gusts").cover).toBeGreaterThan(of("breeze").cover + 0.1);
      expect(of("autumn-gusts").cover).toBeLessThan(0.85);
      expect(of("storm-front").cover).toBe(1);
      expect(of("storm-front").dark).toBeGreaterThan(0.8);
    }
  });

  it("changes smoothly, reaches the new weather exactly, and stands still without time", () => {
    const from = weatherFor(3, 0.3);
    const to = weatherFor(20, 0.3);
    expect(easeWeather(from, to, 0)).toEqual(from);
    let now = from;
    for (let k = 0; k < 600; k++) {
      const next = easeWeather(now, to, 1 / 30);
      expect(next.cover).toBeGreaterThanOrEqual(now.cover);
      expect(next.cover - now.cover).toBeLessThan(0.02);
      now = next;
    }
    expect(now).toEqual(to);
    // One long step arrives where many short ones do.
    const many = Array.from({ length: 30 }).reduce<typeof from>((at) => easeWeather(at, to, 0.1), from);
    expect(easeWeather(from, to, 3).cover).toBeCloseTo(many.cover, 9);
  });

  it("leaves a clear sky as it is, and dims every colour below clouds", () => {
    const clear = { sunlight: [5, 4.6, 4], skylight: [0.5, 0.7, 1.1] } as const;
    const open = belowClouds(clear, 0.8, weatherFor(0, 0), 0);
    for (const c of [0, 1, 2] as const) {
      expect(open.sunlight[c]).toBeCloseTo(clear.sunlight[c], 9);
      expect(open.skylight[c]).toBeCloseTo(clear.skylight[c], 9);
    }
    const storm = belowClouds(clear, 0.8, weatherFor(22, 0.3), 1);
    expect(sum(storm.sunlight)).toBeLessThan(0.05 * sum(clear.sunlight));
    const total = (light: typeof open) => 0.8 * sum(light.sunlight) + sum(light.skylight);
    expect(total(storm)).toBeLessThan(0.3 * total(open));
    // Shadows fade: the sky's share of the light grows to nearly all of it.
    expect(sum(storm.skylight) / total(storm)).toBeGreaterThan(0.8);
    expect(sum(open.skylight) / total(open)).toBeLessThan(0.3);
  });

  it("never gives a negative or infinite light, at any hour", () => {
    for (const season of SEASONS) {
      for (const daytime of [0, 0.02, 0.5, 0.97, 1]) {
        const clear = atmosphereAt(daytime, season);
        for (const speed of [0, 5, 9, 14, 30]) {
          const light = underClouds(clear, season, weatherFor(speed, 0.3), 0.5);
          expect(light.exposure).toBeGreaterThan(0);
          expect(light.exposure).toBeLessThan(1000); // that of a moonlit night is some hundreds
          for (const value of [...light.sunlight, ...light.skylight, ...light.haze]) {
            expect(value).toBeGreaterThanOrEqual(0);
            expect(value).toBeLessThan(20);
          }
        }
      }
    }
  });

  it("integrates the overcast sky to its irradiance", () => {
    let irradiance = 0;
    const steps = 20_000;
    for (let k = 0; k < steps; k++) {
      const angle = ((k + 0.5) / steps) * (Math.PI / 2);
      const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
      irradiance += overcastRadiance(sine) * sine * 2 * Math.PI * cosine * (Math.PI / 2 / steps);
    }
    expect(irradiance).toBeCloseTo(1, 6);
  });
});

describe("a cloud before the sun", () => {
  const noise = paintNoise(64);
  const sun = { x: 0.5, y: 0.7, z: 0.5 };

  it("never hides it without clouds, always below a closed cover", () => {
    for (let k = 0; k < 50; k++) {
      const drift = { x: 0.37 * k, y: -0.21 * k };
      expect(behindCloud(noise, sun, drift, -2)).toBe(0);
      expect(behindCloud(noise, sun, drift, 1)).toBe(1);
    }
  });

  it("covers about as much of the sky as it says", () => {
    for (const cover of [0.2, 0.3, 0.5, 0.7, 0.8]) {
      let inside = 0;
      const count = 4000;
      for (let k = 0; k < count; k++) {
        if (cloudBody(noise, 1.37 * k, 0.91 * k) > cloudEdge(cover)) inside++;
      }
      expect(Math.abs(inside / count - cover)).toBeLessThan(0.08);
    }
  });
});

describe("exposure", () => {
  const GREEN = [0.1, 0.2, 0.04, 1];
  const sun = { x: 0.3, y: 0.9, z: Math.sqrt(1 - 0.09 - 0.81) };
  const gaze: Gaze = {
    eye: { x: 0, y: 1.7, z: 0 },
    forward: { x: 0, y: 0, z: -1 },
    right: { x: 1, y: 0, z: 0 },
    up: { x: 0, y: 1, z: 0 },
    halfWidth: 0.75,
    halfHeight: 0.42,
  };
  const scene = (crowns: number[], density = 0.92) => ({ crowns: Float32Array.from(crowns), sun, ground_m: 0, density });
  const grove: number[] = [];
  for (let x = -40; x <= 40; x += 5) for (let z = -40; z <= 40; z += 5) grove.push(x, 8, z, 3.4, 4.5, ...GREEN);

  it("finds the surface of a crown", () => {
    const crowns = Float32Array.from([0, 5, -10, 2, 4, ...GREEN]);
    const level = { x: 0, y: 0, z: -1 };
    expect(crownDistance({ x: 0, y: 5, z: 0 }, level, crowns, 0)).toBeCloseTo(8, 9);
    expect(crownDistance({ x: 0, y: 5, z: -10 }, level, crowns, 0)).toBe(0);
    expect(crownDistance({ x: 0, y: 5, z: -20 }, level, crowns, 0)).toBe(Number.POSITIVE_INFINITY);
    expect(crownDistance({ x: 0, y: 9.5, z: 0 }, level, crowns, 0)).toBe(Number.POSITIVE_INFINITY);
    expect(crownDistance({ x: 0, y: 0, z: -10 }, { x: 0, y: 1, z: 0 }, crowns, 0)).toBeCloseTo(1, 9);
  });

  it("is 1 in the open, less high above it, more below crowns, less without leaves, and stays within its limits", () => {
    expect(viewLight(gaze, scene([]))).toBe(1);
    expect(gainFor(1)).toBe(1);
    expect(gainFor(1, 1, 60)).toBeLessThan(0.8);
    const below = viewLight(gaze, scene(grove));
    const bare = viewLight(gaze, scene(grove, 0.25));
    expect(below).toBeLessThan(0.5);
    expect(bare).toBeGreaterThan(below);
    expect(gainFor(below)).toBeGreaterThan(gainFor(bare));
    for (const light of [0, 1e-9, 0.1, 0.5, 1]) {
      for (const above_m of [0, 20, 100]) {
        expect(gainFor(light, 1, above_m)).toBeGreaterThanOrEqual(0.75);
        expect(gainFor(light, 1, above_m)).toBeLessThanOrEqual(MOST_GAIN);
      }
    }
  });

  it("eases within about a second, without overshoot, and then stands still", () => {
    let gain = 1;
    for (let k = 0; k < 60; k++) {
      const next = easeGain(gain, 1.7, 1 / 60);
      expect(next).toBeGreaterThanOrEqual(gain);
      expect(next).toBeLessThanOrEqual(1.7);
      gain = next;
    }
    expect(gain).toBeGreaterThan(1.55);
    for (let k = 0; k < 200; k++) gain = easeGain(gain, 1.7, 1 / 60);
    expect(gain).toBe(1.7);
    expect(easeGain(1.2, 1.7, 0)).toBe(1.2);
  });

  it("uses only crowns near the eye", () => {
    const crowns = Float32Array.from([...grove, 500, 8, 0, 3, 4, ...GREEN]);
    const near = crownsNear(crowns, { x: 0, z: 0 });
    expect(near.length).toBeGreaterThan(0);
    for (let at = 0; at < near.length; at += CROWN_FLOATS) {
      expect(Math.hypot(near[at], near[at + 2])).toBeLessThanOrEqual(NEAR_M + near[at + 3]);
    }
  });
});
