import { describe, expect, it } from "vitest";
import { canopyFrom_m, canopyHeight_m } from "../../../web/src/scene/background/canopy";
import { growthAt, REACH_M, shareDrawn, THINNING_LEVELS } from "../../../web/src/scene/background/farPlaces";

describe("the canopy seen from afar", () => {
  it("begins beyond the simulated trees, and without a background where this would end", () => {
    expect(canopyFrom_m(70, true)).toBeGreaterThan(70);
    expect(canopyFrom_m(70, false)).toBe(REACH_M);
    expect(canopyFrom_m(900, false)).toBeGreaterThan(900);
  });

  it("rises without a step from the ground to below the tops", () => {
    for (const from_m of [80, 300, 420, 900]) {
      let before = canopyHeight_m(from_m, from_m, 18);
      expect(before).toBe(0);
      for (let distance_m = from_m; distance_m < 1600; distance_m += 1) {
        const height_m = canopyHeight_m(distance_m, from_m, 18);
        expect(height_m).toBeGreaterThanOrEqual(before - 1e-9);
        expect(height_m - before).toBeLessThan(0.7);
        before = height_m;
      }
      expect(before).toBeGreaterThan(0.8 * 18);
      expect(before).toBeLessThan(18);
    }
  });

  it("keeps the area of the crowns that are drawn nearly the same where trees are thinned a little", () => {
    for (const level of Object.values(THINNING_LEVELS)) {
      for (let away_m = 1; away_m < 1.7 * level.full_m; away_m += 5) {
        const share = shareDrawn(away_m, level);
        expect(share * growthAt(share) ** 2).toBeGreaterThan(0.75);
      }
    }
  });
});
