import { describe, expect, test } from "vitest";
import { groundUnder } from "../../../web/player/src/core/math/groundRay";
import { nearestTree, tipDisplacement_m, tipNode } from "../../../web/player/src/core/motion/tip";
import { bearingFrom_deg, beaufort, directionFrom_deg, windInWords, windName } from "../../../web/src/page/ui/instruments/beaufort";
import { dialTurn_deg, placeOfWind, windAfterKey, windAtPlace } from "../../../web/src/page/ui/instruments/dial";
import { kolmogorovLine, powerSpectrum } from "../../../web/src/page/ui/instruments/powerSpectrum";
import { KEPT_SAMPLES, RATE_HZ, Recorder } from "../../../web/src/page/ui/instruments/recorder";
import { presetAt, presetOf, withModel } from "../../../web/src/page/ui/instruments/windEditing";
import { WIND_MODELS } from "../../../web/player/src/core/constants";
import { parseWind } from "../../../web/player/src/core/wind/document";
import { CALM_BREEZE, PRESETS, type PresetName } from "../../../web/player/src/core/wind/presets";
import { random } from "../golden";

describe("Beaufort", () => {
  test.each([
    [0, 0, "calm"],
    [0.29, 0, "calm"],
    [5.5, 4, "moderate breeze"],
    [20.8, 9, "strong gale"],
    [60, 12, "hurricane"],
  ])("%f m/s is force %i, %s", (speed, force, name) => expect(beaufort(speed)).toEqual({ force, name }));

  test("names the direction the wind comes from, as forecasts do", () => {
    expect(windName(0)).toBe("westerly"); // towards x, which is east
    expect(windName(-90)).toBe("southerly");
    expect(windName(359)).toBe("westerly");
    expect(windInWords(7, 45)).toBe("North-westerly, 7 m/s: moderate breeze (Beaufort 4)");
    expect(windInWords(7.54, 90)).toBe("Northerly, 7.5 m/s: moderate breeze (Beaufort 4)");
    expect(windInWords(0, 90)).toBe("Still air: calm (Beaufort 0)");
  });

  test("bearing and direction are inverse functions", () => {
    for (let direction = 0; direction < 360; direction += 7) {
      expect(directionFrom_deg(bearingFrom_deg(direction))).toBeCloseTo(direction, 9);
      // the air comes from where the bearing points: (sin, -cos) in (x, z), against the velocity
      const [to, from] = [direction, bearingFrom_deg(direction)].map((angle) => (angle * Math.PI) / 180);
      expect(Math.sin(from)).toBeCloseTo(-Math.cos(to), 12);
      expect(-Math.cos(from)).toBeCloseTo(-Math.sin(to), 12);
    }
  });
});

describe("the dial", () => {
  test("the viewing direction is at the top", () => {
    for (const [x, z] of [[0, -1], [1, 0], [-0.6, 0.8]]) {
      const ahead_deg = (Math.atan2(z, x) * 180) / Math.PI;
      const { right, down } = placeOfWind({ direction_deg: ahead_deg, mean_speed_m_s: 60 }, dialTurn_deg({ x, z }));
      expect(right).toBeCloseTo(0, 12);
      expect(down).toBeCloseTo(-1, 12);
    }
  });

  test("position and wind are inverse functions, for random rotations (seed 3)", () => {
    const next = random(3);
    for (let k = 0; k < 200; k++) {
      const turn = 720 * next() - 360;
      const wind = { direction_deg: Math.floor(360 * next()), mean_speed_m_s: Math.round(10 + 590 * next()) / 10 };
      const found = windAtPlace(placeOfWind(wind, turn), turn, wind);
      expect(found).toEqual(wind);
    }
  });

  test("the centre gives still air and keeps the direction", () => {
    const before = { direction_deg: 77, mean_speed_m_s: 3 };
    expect(windAtPlace({ right: 0, down: 0.01 }, 5, before)).toEqual({ direction_deg: 77, mean_speed_m_s: 0 });
  });

  test("keys change direction and speed within the range", () => {
    const wind = { direction_deg: 2, mean_speed_m_s: 59.8 };
    expect(windAfterKey("ArrowLeft", wind)?.direction_deg).toBe(357);
    expect(windAfterKey("ArrowUp", wind)?.mean_speed_m_s).toBe(60);
    expect(windAfterKey("Home", wind)?.mean_speed_m_s).toBe(0);
    expect(windAfterKey("x", wind)).toBeNull();
  });
});

describe("editing", () => {
  test("every model of every preset is a valid wind, also after a round trip", () => {
    for (const name of Object.keys(PRESETS) as PresetName[]) {
      for (const model of WIND_MODELS) {
        const wind = withModel(presetAt(name, 200), model);
        expect(parseWind(wind)).toEqual(wind);
        expect(parseWind(withModel(wind, "cosine")).model).toBe("cosine");
      }
      expect(presetOf(presetAt(name, 200))).toBe(name);
    }
    expect(presetOf(CALM_BREEZE)).toBeNull();
  });
});

describe("the anemometer", () => {
  test("samples at equal steps, drops the oldest and restarts after a jump", () => {
    const recorder = new Recorder();
    const measure = (time_s: number) => ({ speed_m_s: time_s, tip_m: 2 * time_s });
    for (let k = 0; k < 4000; k++) recorder.advance(k * 0.02, measure);
    expect(recorder.count).toBe(KEPT_SAMPLES);
    const { time_s, speed_m_s, tip_m, count } = recorder;
    for (let k = 1; k < count; k++) expect(time_s[k] - time_s[k - 1]).toBeCloseTo(1 / RATE_HZ, 9);
    expect(speed_m_s[7]).toBe(time_s[7]);
    expect(tip_m[count - 1]).toBe(2 * time_s[count - 1]);
    recorder.advance(1000, measure);
    expect(recorder.count).toBe(1);
  });

  test("the power of a sine is half its squared amplitude, at its frequency", () => {
    const values = Float64Array.from({ length: 2048 }, (_, k) => 5 + 3 * Math.sin((2 * Math.PI * 1.2 * k) / 30));
    const spectrum = powerSpectrum(values, 2048, 30);
    if (!spectrum) throw new Error("no spectrum");
    const total = spectrum.power.reduce((sum, value) => sum + value, 0) * (30 / 512);
    expect(total).toBeCloseTo(4.5, 2);
    expect(spectrum.frequency_hz[spectrum.power.indexOf(Math.max(...spectrum.power))]).toBeCloseTo(1.2, 1);
    expect(powerSpectrum(values, 100, 30)).toBeNull();
  });

  test("the fitted line has slope −5/3 and the level of the spectrum", () => {
    const frequency_hz = Float64Array.from({ length: 100 }, (_, k) => 0.1 * (k + 1));
    const power = frequency_hz.map((f) => 7 * f ** (-5 / 3));
    const line = kolmogorovLine({ frequency_hz, power }, 0.3, 2);
    line.forEach((value, k) => {
      expect(value).toBeCloseTo(power[k], 9);
    });
  });
});

test("the tip is the node that moves most, and its displacement is a distance", () => {
  const basis = new Float32Array(2 * 3 * 4);
  basis[0] = 1; // node 0, x, mode 0
  basis[12 + 8] = 3; // node 1, z, mode 0
  basis[12 + 5] = 4; // node 1, y, mode 1
  const motion = { stride: 4, modes: 2, basis };
  expect(tipNode(motion)).toBe(1);
  expect(tipDisplacement_m(motion, 1, [1, 1, 0, 0], 2)).toBeCloseTo(10, 6);
});

test("finds the nearest tree among all groups", () => {
  const placements = [new Float32Array([0, 0, 0, 1, 10, 0, 0, 1]), new Float32Array([4, 4, 0, 1])];
  expect(nearestTree(placements, 5, 3)).toEqual({ group: 1, tree: 0 });
  expect(nearestTree(placements, 9, 0)).toEqual({ group: 0, tree: 1 });
  expect(nearestTree([], 0, 0)).toBeNull();
});

test("a ray intersects the ground at its height", () => {
  const height = (x: number, z: number) => 2 * Math.sin(x / 20) + z / 50;
  const ray = { from: { x: 0, y: 15, z: 0 }, to: { x: 0.6, y: -0.36, z: 0.71 } };
  const place = groundUnder(ray, height);
  if (!place) throw new Error("no ground");
  const s = place.x / ray.to.x;
  expect(15 + s * ray.to.y).toBeCloseTo(height(place.x, place.z), 3);
  expect(groundUnder({ ...ray, to: { x: 0, y: 1, z: 0 } }, height)).toBeNull();
});
