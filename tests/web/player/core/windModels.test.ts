import { describe, expect, test, vi } from "vitest";
import { EDDY_EPOCH, EDDY_STEPS_PER_SCALE } from "../../../../web/player/src/core/constants";
import { parseWind, resolveWind, type WindDocument } from "../../../../web/player/src/core/wind/document";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { changeWind, finalWind, parseState, steady, withFront } from "../../../../web/player/src/core/wind/transition";
import { EddyGusts } from "../../../../web/player/src/core/wind/models/eddyGusts";
import { Eddies } from "../../../../web/player/src/core/wind/models/navierStokes";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { goldenJson } from "../../golden";

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
  fronts: {
    start: WindDocument;
    fronts: [time_s: number, x_m: number, z_m: number][];
    state: unknown;
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
  field.velocity(golden.x_m, golden.z_m, field.at(time_s), x, z);
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

test("a change while one model fades into another waits, and is part of the state that is sent", () => {
  const [first, second] = golden.changed.changes.map(({ wind }) => parseWind(wind));
  const fading = changeWind(steady(parseWind(golden.changed.start)), first, 0.5);
  const waiting = changeWind(fading, second, 0.6);
  expect(waiting).toEqual({ ...fading, next: second });
  expect(finalWind(waiting)).toEqual(second);
  expect(parseState(JSON.parse(JSON.stringify(waiting)))).toEqual(waiting);
  expect(() => parseState({ ...waiting, next: { version: 2 } })).toThrow(/version/);
});

test("gust fronts travel as in Python, and only the last four are kept", () => {
  const { start, fronts, state, times_s, velocity_m_s } = golden.fronts;
  const sent = fronts.reduce((now, [time_s, x, z]) => withFront(now, x, z, time_s), steady(parseWind(start)));
  expect(sent.fronts).toEqual(parseState(state).fronts);
  const field = new WindField(sent);
  times_s.forEach((time_s, row) => {
    expect(difference(field, time_s, velocity_m_s[row])).toBeLessThan(RELATIVE);
  });
  expect(() => parseState({ ...(state as object), fronts: [{ since_s: 0 }] })).toThrow(/fronts\[0\]\.x_m/);
});

test("the eddies are bit-identical", () => {
  const eddies = new Eddies(5);
  for (const { steps, cells } of golden.eddies) {
    while (eddies.steps < steps) eddies.finish();
    const at = [0, 77, 8000, 16383];
    expect([...at.map((i) => eddies.past(0).u[i]), ...at.map((i) => eddies.past(0).v[i])]).toEqual(cells);
  }
});

test("eddies asked alternately for the present and a moment ahead are the same, and no step is computed twice", () => {
  const finish = vi.spyOn(Eddies.prototype, "finish");
  const wind = resolveWind(PRESETS["storm-front"]);
  const [x, z] = [Float64Array.of(3, 900, -40), Float64Array.of(-7, 20, 500)];
  const at = (gusts: EddyGusts, steps: number) => {
    const [outX, outZ] = [new Float64Array(3), new Float64Array(3)];
    gusts.velocity(wind, steps / EDDY_STEPS_PER_SCALE, x, z, outX, outZ);
    return [...outX, ...outZ];
  };
  const [both, present, ahead] = [new EddyGusts(3), new EddyGusts(3), new EddyGusts(3)];
  const moments = Array.from({ length: 60 }, (_, k) => EDDY_EPOCH - 1.5 + 0.05 * k);
  const alternately = moments.map((steps) => [at(both, steps), at(both, steps + 0.3)]);
  const computed = finish.mock.calls.length;
  const alone = moments.map((steps) => [at(present, steps), at(ahead, steps + 0.3)]);
  expect(alternately).toEqual(alone);
  // the run of the first epoch up to its end, and of the next one from there
  expect(computed).toBeLessThanOrEqual(EDDY_EPOCH + 2 * 3 + 1);
  finish.mockRestore();
});

describe("rejects with the same path and message as Python", () => {
  golden.refused.forEach(({ document, path, expected }, k) => {
    test(`${k}: ${path}`, () => {
      expect(() => parseWind(document)).toThrow(expect.objectContaining({ path, expected }));
    });
  });
});

test("a change keeps the gusts that blow: vortices are not computed a second time", () => {
  const wind = { version: 1, mean_speed_m_s: 8, direction_deg: 0, gustiness: 0.5, convection_speed_m_s: 8, length_scale_m: 20 };
  const eddies = parseWind({ ...wind, model: "navier-stokes", seed: 5 });
  const [first, second] = [2, 3].map((seed) => parseWind({ ...wind, model: "perlin", seed }));
  const field = new WindField(eddies);
  const kept = (field as unknown as { gusts: Map<string, unknown> }).gusts;
  const [x, z, outX, outZ] = Array.from({ length: 4 }, () => new Float64Array(1));
  field.velocity(x, z, field.at(0), outX, outZ);
  const [blowing] = kept.values();
  // Back to the vortices, and on to other gusts: they have been there longest, but still fade out.
  for (const [k, next] of [first, eddies, second].entries()) {
    field.change(next, 60 * k);
    for (const later_s of [0.5, 50]) {
      field.velocity(x, z, field.at(60 * k + later_s), outX, outZ);
      if (later_s < 1) expect([...kept.values()]).toContain(blowing);
    }
  }
  expect(kept.size).toBe(2);
});
