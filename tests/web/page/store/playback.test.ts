import { effect } from "@preact/signals-core";
import { describe, expect, test } from "vitest";
import { Playback, STEP_S } from "../../../../web/src/page/store/playback";
import { presetOf } from "../../../../web/src/page/ui/instruments/windEditing";
import { PRESETS, type PresetName } from "../../../../web/player/src/core/wind/presets";

describe("playback", () => {
  test("plays real time, or a part of it", () => {
    const playback = new Playback();
    expect(playback.advance_s(0.1, false)).toBe(0.1);
    playback.speed = 0.25;
    expect(playback.advance_s(0.1, false)).toBeCloseTo(0.025, 12);
    expect(playback.advance_s(0.1, true)).toBe(0.1); // the server sets the pace of its stream
  });

  test("stands still while paused, but for single steps", () => {
    const seen: boolean[] = [];
    const playback = new Playback();
    effect(() => {
      seen.push(playback.paused);
    });
    playback.step();
    expect(playback.paused).toBe(true);
    expect(playback.advance_s(0.1, false)).toBe(STEP_S);
    expect(playback.advance_s(0.1, false)).toBeNull();
    playback.step();
    playback.step();
    expect([1, 2, 3].map(() => playback.advance_s(0.1, false))).toEqual([STEP_S, STEP_S, null]);
    playback.step();
    playback.paused = false;
    expect(playback.advance_s(0.1, false)).toBe(0.1);
    expect(seen).toEqual([false, true, false]);
  });
});

test.each(Object.keys(PRESETS) as PresetName[])("a preset is recognised in spite of rounding: %s", (name) => {
  const rounded = Object.fromEntries(
    Object.entries(PRESETS[name]).map(([key, value]) => [key, typeof value === "number" && key !== "seed" ? value * (1 - 1.2e-16) : value]),
  );
  expect(presetOf(rounded as never)).toBe(name);
});
