import { describe, expect, test } from "vitest";
import { isFrameDue } from "../../../web/src/page/forest/frameStatistics";

/** Number of frames drawn in ten seconds on a display with this rate, whose refreshes come up to 0.5 ms early or late. */
function drawn(display_hz: number, limit_hz: number): number {
  let last_ms = 0;
  let count = 0;
  for (let k = 1; k <= 10 * display_hz; k++) {
    const now_ms = (1000 * k) / display_hz + (k % 2 ? 0.5 : -0.5);
    if (!isFrameDue(now_ms - last_ms, limit_hz)) continue;
    last_ms = now_ms;
    count++;
  }
  return count;
}

describe("the limit of the frame rate", () => {
  test("draws every second or fourth picture of a display of 60 Hz", () => {
    expect(drawn(60, 30)).toBe(300);
    expect(drawn(60, 15)).toBe(150);
  });

  test("leaves out nothing at the limit of a fast display, and never draws more than allowed", () => {
    expect(drawn(144, 240)).toBe(1440);
    for (const limit_hz of [5, 24, 50]) expect(drawn(144, limit_hz)).toBeLessThanOrEqual(1.02 * 10 * limit_hz);
  });
});
