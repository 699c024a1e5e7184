import { describe, expect, test } from "vitest";
import { parseWind, type WindDocument, WindField } from "../../web/src/core/wind/wind";
import { Eddies } from "../../web/src/core/wind/models/navierStokes";
import { goldenJson } from "./golden";

interface Golden {
  frame_s: number;
  frames: number[];
  x_m: number[];
  z_m: number[];
  models: { wind: WindDocument; velocity_m_s: number[][] }[];
  changed: {
    start: WindDocument;
    changes: { time_s: number; wind: WindDocument }[];
    times_s: number[];
    velocity_m_s: number[][];
  };
  eddies: { steps: number; cells: number[] }[];
  refused: { document: unknown; path: string; expected: string }[];
}

const golden = goldenJson<Golden>("wind_models.json");
const RELATIVE = 1e-9;
const count = golden.x_m.length;

/** Largest difference in a frame relative to the frame's magnitude. */
function difference(field: WindField, time_s: number, wanted: number[]): number {
  const x = new Float64Array(count);
  const z = new Float64Array(count);
  field.velocity(golden.x_m, golden.z_m, time_s, x, z);
  const size = Math.max(...wanted.map(Math.abs), 1e-12);
  return Math.max(...[...x, ...z].map((value, i) => Math.abs(value - wanted[i]))) / size;
}

describe("agrees with the velocities of Python over 10,000 frames", () => {
  golden.models.forEach(({ wind, velocity_m_s }, k) => {
    test(`${wind.model} (${k}), seed ${wind.seed}`, () => {
      const field = new WindField(parseWind(wind));
      golden.frames.forEach((frame, row) => {
        expect(difference(field, frame * golden.frame_s, velocity_m_s[row])).toBeLessThan(RELATIVE);
      });
    });
  });
});

test("a change of the wind gives the same transition", () => {
  const { start, changes, times_s, velocity_m_s } = golden.changed;
  const field = new WindField(parseWind(start));
  const waiting = [...changes];
  times_s.forEach((time_s, row) => {
    while (waiting.length > 0 && waiting[0].time_s <= time_s) {
      const next = waiting.shift();
      if (next) field.change(parseWind(next.wind), time_s);
    }
    expect(difference(field, time_s, velocity_m_s[row])).toBeLessThan(RELATIVE);
  });
});

test("the eddies are bit-identical", () => {
  const eddies = new Eddies(5);
  for (const { steps, cells } of golden.eddies) {
    while (eddies.steps < steps) eddies.finish();
    const at = [0, 77, 8000, 16383];
    expect([...at.map((i) => eddies.u[i]), ...at.map((i) => eddies.v[i])]).toEqual(cells);
  }
});

describe("rejects with the same path and message as Python", () => {
  golden.refused.forEach(({ document, path, expected }, k) => {
    test(`${k}: ${path}`, () => {
      expect(() => parseWind(document)).toThrow(expect.objectContaining({ path, expected }));
    });
  });
});
