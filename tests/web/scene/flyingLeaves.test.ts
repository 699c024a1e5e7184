import { describe, expect, it } from "vitest";
import { groundHeight_m } from "../../../web/src/scene/ground/landscape";
import { FlyingLeaves } from "../../../web/src/scene/season/flyingLeaves";
import { type Flight, flightFrom, leafAt, looseShare } from "../../../web/src/scene/season/leafFlight";
import { SEASONS } from "../../../web/src/scene/season/season";
import { snowShare } from "../../../web/src/scene/sky/weather";
import { seededRandom } from "../seeded";

/** Flights from random places, up to 14 m above the land, in random winds. */
function flights(seed: number, count: number): { flight: Flight; wind: { x: number; z: number } }[] {
  const random = seededRandom(seed);
  return Array.from({ length: count }, (_, k) => {
    const [x, z] = [200 * (random() - 0.5), 200 * (random() - 0.5)];
    const y = groundHeight_m(x, z) + 1.5 + 12 * random();
    const [speed, heading] = [30 * random(), 2 * Math.PI * random()];
    const wind = { x: speed * Math.cos(heading), z: speed * Math.sin(heading) };
    return { flight: flightFrom({ x, y, z }, wind, k, groundHeight_m), wind };
  });
}

describe("leaves that the wind tears off", () => {
  it("come from the crowns around the eye, but not from those of evergreens", () => {
    const crownAt = (x: number, falling: number) => [x, 12, 0, 3, 5, 0.4, 0.3, 0.1, falling];
    const born = (...crowns: number[][]) => {
      const leaves = new FlyingLeaves("low", () => 0);
      const given = Float32Array.from(crowns.flat());
      for (let k = 0; k < 40; k++) leaves.advance(0.05, { x: 15, z: 0 }, "autumn", given, { x: 0, z: 0 });
      const from = leaves.mesh.geometry.getAttribute("aFrom");
      const xs = Array.from({ length: from.count }, (_, k) => from.getX(k)).filter((x) => x < 1e8);
      leaves.dispose();
      return xs;
    };
    expect(born(crownAt(0, 0))).toEqual([]);
    const both = born(crownAt(0, 0), crownAt(30, 1));
    expect(both.length).toBeGreaterThan(20);
    for (const x of both) expect(Math.abs(x - 30)).toBeLessThan(3);
  });

  it("repeats the same flight for the same leaf and wind", () => {
    const from = { x: 1, y: 9, z: -3 };
    const wind = { x: 12, z: 4 };
    expect(flightFrom(from, wind, 5, groundHeight_m)).toEqual(flightFrom(from, wind, 5, groundHeight_m));
    expect(flightFrom(from, wind, 6, groundHeight_m)).not.toEqual(flightFrom(from, wind, 5, groundHeight_m));
  });

  it("starts at the twig, lands on the ground, and stays above it on the way", () => {
    for (const { flight } of flights(11, 400)) {
      const start = leafAt(flight, 0);
      expect(Math.hypot(start.x - flight.x, start.y - flight.y, start.z - flight.z)).toBeLessThan(1e-9);
      for (let k = 1; k <= 40; k++) {
        const { x, y, z } = leafAt(flight, (k / 40) * flight.lands_s);
        // Between the checked points the land may rise a little.
        expect(y).toBeGreaterThan(groundHeight_m(x, z) - 0.25);
      }
      const end = leafAt(flight, flight.lands_s);
      expect(Math.abs(end.y - groundHeight_m(end.x, end.z))).toBeLessThan(0.3);
      expect(leafAt(flight, flight.lands_s + 10)).toEqual(end);
    }
  });

  it("moves downwind and down, and farther in stronger wind", () => {
    for (const { flight, wind } of flights(12, 400)) {
      const speed = Math.hypot(wind.x, wind.z);
      if (speed < 2) continue;
      const end = leafAt(flight, flight.lands_s);
      const downwind_m = ((end.x - flight.x) * wind.x + (end.z - flight.z) * wind.z) / speed;
      expect(downwind_m).toBeGreaterThan(0);
      expect(downwind_m).toBeLessThan(speed * flight.lands_s);
      expect(end.y).toBeLessThan(flight.y);
    }
    const level = () => 0;
    const far = (speed: number) => leafAt(flightFrom({ x: 0, y: 8, z: 0 }, { x: speed, z: 0 }, 3, level), 60).x;
    for (const speed of [2, 5, 10, 20]) expect(far(1.5 * speed)).toBeGreaterThan(far(speed));
  });

  it("depends on wind and season: none in winter, most in autumn, more in stronger wind", () => {
    for (let speed = 0; speed <= 40; speed++) {
      expect(looseShare(speed, "winter")).toBe(0);
      for (const season of SEASONS) {
        expect(looseShare(speed + 1, season)).toBeGreaterThanOrEqual(looseShare(speed, season));
        expect(looseShare(speed, season)).toBeLessThanOrEqual(looseShare(speed, "autumn"));
      }
    }
    for (const season of SEASONS) expect(looseShare(0, season)).toBe(0);
    expect(looseShare(20, "autumn")).toBe(1);
    // A storm tears green leaves off too; a breeze hardly any.
    expect(looseShare(20, "summer")).toBeGreaterThan(0.5);
    expect(looseShare(9, "summer")).toBeLessThan(0.03);
  });

  it("drives snow in winter storms only", () => {
    expect(snowShare(20, "winter")).toBe(1);
    expect(snowShare(4, "winter")).toBe(0);
    for (const season of SEASONS) if (season !== "winter") expect(snowShare(25, season)).toBe(0);
  });
});
