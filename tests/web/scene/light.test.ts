import { describe, expect, it } from "vitest";
import { AEROSOL_G, aerosolPhase, skyIrradiance, skyTable, sunlight } from "../../../web/src/scene/sky/atmosphere";
import { atmosphereAt, clockOf, DAYTIMES, exposureFor, halfDay_h, hourOf, sunPlace, underClouds } from "../../../web/src/scene/sky/daytime";
import { weatherFor } from "../../../web/src/scene/sky/weather";
import { SEASON_LOOKS, SEASONS } from "../../../web/src/scene/season/season";

const luminance = ([r, g, b]: readonly number[]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const DEG = Math.PI / 180;
const sum = (light: readonly number[]) => light[0] + light[1] + light[2];

describe("light of the sky", () => {
  it("transmits an overhead sun as given by the scale heights", () => {
    const [r, g, b] = sunlight(0, 1, 1);
    // The vertical depth of an exponential layer is its coefficient times its scale height; ozone is a triangle of 15 km.
    const depth = (rayleigh: number, ozone: number) => rayleigh * 8000 + 4.436e-6 * 1200 + ozone * 15_000;
    expect(r).toBeCloseTo(Math.exp(-depth(5.802e-6, 0.65e-6)), 2);
    expect(g).toBeCloseTo(Math.exp(-depth(13.558e-6, 1.881e-6)), 2);
    expect(b).toBeCloseTo(Math.exp(-depth(33.1e-6, 0.085e-6)), 2);
  });

  it("reddens the sun towards the horizon and blocks it below", () => {
    const ratio = (elevation_deg: number) => {
      const [r, , b] = sunlight(0, Math.sin(elevation_deg * DEG), 1.5);
      return b / r;
    };
    const ratios = [60, 30, 10, 4, 1].map(ratio);
    for (let k = 1; k < ratios.length; k++) expect(ratios[k]).toBeLessThan(ratios[k - 1]);
    expect(sum(sunlight(0, Math.sin(-4 * DEG), 1))).toBe(0);
  });

  it("is blue overhead at noon and no brighter than the sun", () => {
    const table = skyTable(60 * DEG, 1.5);
    const zenith = (table.elevations - 1) * table.azimuths * 3;
    expect(table.light[zenith + 2]).toBeGreaterThan(2 * table.light[zenith]);
    const sky = skyIrradiance(table, 60 * DEG);
    for (let c = 0; c < 3; c++) {
      expect(sky[c]).toBeGreaterThan(0);
      expect(sky[c] + sunlight(0, Math.sin(60 * DEG), 1.5)[c] * Math.sin(60 * DEG)).toBeLessThan(1);
    }
  });

  it("has a normalized aerosol phase function", () => {
    let total = 0;
    const steps = 20_000;
    for (let k = 0; k < steps; k++) total += (aerosolPhase(-1 + (2 * (k + 0.5)) / steps) * 4 * Math.PI) / steps;
    expect(total).toBeCloseTo(1, 3);
    expect(aerosolPhase(1)).toBeCloseTo((1 - AEROSOL_G ** 2) / (4 * Math.PI * (1 - AEROSOL_G) ** 3), 6);
  });
});

describe("time of day", () => {
  it("puts the noon sun in the south at the elevation given by latitude and declination", () => {
    for (const season of SEASONS) {
      const { azimuth_deg, elevation_deg } = sunPlace(0.5, season);
      expect(azimuth_deg).toBeCloseTo(90, 6);
      expect(elevation_deg).toBeCloseTo(90 - 47 + SEASON_LOOKS[season].declination_deg, 6);
    }
  });

  it("has twelve hours of daylight at the equinox and the sun on the horizon six hours after noon", () => {
    expect(halfDay_h(0)).toBeCloseTo(6, 9);
    const half = halfDay_h(SEASON_LOOKS.winter.declination_deg);
    expect(half).toBeLessThan(5);
    const sunset = 0.5 + half / (2 * (hourOf(1, "winter") - 12));
    expect(sunPlace(sunset, "winter").elevation_deg).toBeCloseTo(0, 6);
    expect(sunPlace(sunset, "winter").azimuth_deg).toBeGreaterThan(90); // in the west, which is 180
  });

  it("runs from sunrise in the east to sunset, and the clock follows", () => {
    expect(sunPlace(0.1, "summer").azimuth_deg).toBeLessThan(45);
    expect(clockOf(0.5, "autumn")).toBe("12:00");
    for (let t = 0; t <= 1; t += 0.05) {
      const light = atmosphereAt(t, "autumn");
      for (const number of [...light.sunlight, ...light.skylight, ...light.haze, light.exposure, light.mist]) {
        expect(Number.isFinite(number) && number >= 0).toBe(true);
      }
    }
  });

  it("never shows less than a fixed light, at any hour, in any season and below any clouds", () => {
    for (const season of SEASONS)
      for (let t = DAYTIMES.min; t <= DAYTIMES.max; t += 0.02) {
        const clear = atmosphereAt(t, season);
        for (const speed_m_s of [0, 8, 14, 20, 30]) {
          const light = underClouds(clear, season, weatherFor(speed_m_s, SEASON_LOOKS[season].clouds), 0);
          const level = Math.max(0.1, Math.sin(Math.max(0, light.sun.elevation_deg) * DEG));
          const shown = light.exposure * (0.55 * luminance(light.sunlight) * level + luminance(light.skylight));
          // At most these shares are taken off in snow and in mist.
          expect(shown, `${season} ${t.toFixed(2)} ${speed_m_s} m/s`).toBeGreaterThan(0.75 * 0.35 * 0.5);
          expect(shown).toBeLessThan(3.2);
        }
      }
  });

  it("adapts partly to a dim light and fully to the dimmest", () => {
    const shown = (light: number, least: number) => light * exposureFor([0, 0, 0], [light, light, light], 0, least);
    for (const light of [1e-5, 1e-3, 0.01]) expect(shown(light, 0.9)).toBeCloseTo(0.9, 9);
    const brighter = [0.1, 0.5, 1, 2, 4].map((light) => shown(light, 0.9));
    for (let k = 1; k < brighter.length; k++) expect(brighter[k]).toBeGreaterThan(brighter[k - 1]);
  });

  it("has a moon above the forest in every night, whose light is bluer than that of the sun", () => {
    for (const season of SEASONS)
      for (const t of [DAYTIMES.min, -0.1, 1.1, DAYTIMES.max]) {
        const { sun, sunlight } = atmosphereAt(t, season);
        expect(sun.elevation_deg).toBeGreaterThan(20);
        expect(sun.elevation_deg).toBeLessThan(60);
        expect(sunlight[2]).toBeGreaterThan(sunlight[0]);
        expect(sum(sunlight)).toBeLessThan(0.05 * sum(atmosphereAt(0.5, season).sunlight));
      }
  });

  it("shows colours by day and hardly any by night, and lets them fade without a jump", () => {
    for (const season of SEASONS) {
      const at = (t: number) => atmosphereAt(t, season).nightVision;
      expect([at(0.05), at(0.5), at(0.95)]).toEqual([0, 0, 0]);
      expect([at(DAYTIMES.min), at(DAYTIMES.max)]).toEqual([1, 1]);
      for (let t = 0.95; t < DAYTIMES.max; t += DAYTIMES.step) {
        expect(at(t + DAYTIMES.step)).toBeGreaterThanOrEqual(at(t));
        expect(at(t + DAYTIMES.step)).toBeLessThan(at(t) + 0.4);
      }
    }
  });

  it("exposes dusk more than noon, but keeps it darker", () => {
    const noon = atmosphereAt(0.5, "summer");
    const dusk = atmosphereAt(0.98, "summer");
    expect(dusk.exposure).toBeGreaterThan(noon.exposure);
    const ground = ({ sun, sunlight, skylight }: typeof noon) =>
      Math.max(0, Math.sin(sun.elevation_deg * DEG)) * sum(sunlight) + sum(skylight);
    expect(dusk.exposure * ground(dusk)).toBeLessThan(noon.exposure * ground(noon));
  });
});
