import { describe, expect, test } from "vitest";
import { parseWind, WIND_RANGES } from "../../../../web/player/src/core/wind/document";
import { WindError } from "../../../../web/player/src/core/wind/fields";
import { CALM_BREEZE } from "../../../../web/player/src/core/wind/presets";
import { dynamicPressure, pressurePerSpeed, speedOfPressure_m_s } from "../../../../web/player/src/core/wind/pressure";
import { goldenJson } from "../../golden";
import { windPressure } from "../../windPressure";

interface Vector {
  wind: unknown;
  time_s: number;
  exponent: number;
  x_m: number[];
  z_m: number[];
  pressure_x_pa: number[];
  pressure_z_pa: number[];
}

test("gives the same pressures as Python", () => {
  for (const row of goldenJson<Vector[]>("wind.json")) {
    const outX = new Float32Array(row.x_m.length);
    const outZ = new Float32Array(row.x_m.length);
    windPressure(parseWind(row.wind), row.x_m, row.z_m, row.time_s, outX, outZ, row.exponent);
    for (let i = 0; i < outX.length; i++) {
      expect(outX[i]).toBeCloseTo(row.pressure_x_pa[i], 4);
      expect(outZ[i]).toBeCloseTo(row.pressure_z_pa[i], 4);
    }
  }
});

test("the pressure of still air is exactly zero", () => {
  const out = new Float32Array(3).fill(1);
  windPressure({ ...CALM_BREEZE, mean_speed_m_s: 0 }, [0, 9, 99], [1, 2, 3], 12, out, out, 1.3);
  expect(out.every((value) => value === 0)).toBe(true);
});

test("gusts travel downwind at the convection speed", () => {
  const wind = { ...CALM_BREEZE, direction_deg: 0, convection_speed_m_s: 5 };
  const here = new Float32Array(1);
  const there = new Float32Array(1);
  const scratch = new Float32Array(1);
  windPressure(wind, [0], [7], 3, here, scratch, 1.3);
  windPressure(wind, [20], [7], 7, there, scratch, 1.3);
  expect(there[0]).toBeCloseTo(here[0], 5);
});

test.each([1.3, 1.64, 2])("the pressure is a parabola up to 5 m/s and a power of %d above", (exponent) => {
  for (const speed of [0, 1, 4.9, 5]) expect(dynamicPressure(speed, exponent)).toBeCloseTo(0.6 * speed ** 2, 12);
  expect(dynamicPressure(5 + 1e-9, exponent)).toBeCloseTo(15, 6);
  for (const speed of [5.5, 10, 30, 60]) {
    const pressure = dynamicPressure(speed, exponent);
    expect(pressure / (15 * (speed / 5) ** exponent)).toBeCloseTo(1, 12);
    expect(speedOfPressure_m_s(pressure, exponent)).toBeCloseTo(speed, 10);
    expect(pressurePerSpeed(speed, exponent) * speed).toBeCloseTo(pressure, 9);
    if (exponent === 2) expect(pressure).toBeCloseTo(0.6 * speed ** 2, 9);
  }
});

describe("rejects", () => {
  for (const [field, [low, high]] of Object.entries(WIND_RANGES)) {
    for (const value of [low - 1, high + 1, Number.NaN, Number.POSITIVE_INFINITY, "8", null, undefined]) {
      test(`${field} = ${String(value)}`, () => {
        expect(() => parseWind({ ...CALM_BREEZE, [field]: value })).toThrow(new RegExp(`wind\\.${field}: .*${low}\\.\\.`));
      });
    }
  }
  test.each([null, 3, [], {}, { ...CALM_BREEZE, version: 2 }, { ...CALM_BREEZE, more: 1 }, { ...CALM_BREEZE, seed: 1.5 }])(
    "%j",
    (document) => expect(() => parseWind(document)).toThrow(WindError),
  );
});
