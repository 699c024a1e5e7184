/** Light of the scene by season and time of day. Pure. */

import { SEASON_LOOKS, type Season } from "../season/season";
import { type Rgb, type SkyTable, skyIrradiance, skyTable, sunlight } from "./atmosphere";

const LATITUDE_DEG = 47;
/** Sunlight above the atmosphere, in the renderer's units. */
export const SUN_POWER = 5.6;
/** The ends of the slider are this share of the day before sunrise and after sunset (twilight). */
const TWILIGHT = 0.015;
/** Height of the clouds, for their lighting. */
const CLOUDS_M = 2500;
const DEG = Math.PI / 180;

export interface SunPlace {
  /** 0 = +x (east), 90 = +z (south). */
  readonly azimuth_deg: number;
  readonly elevation_deg: number;
}

/** Hours from noon to sunset. */
export function halfDay_h(declination_deg: number): number {
  const cosine = -Math.tan(LATITUDE_DEG * DEG) * Math.tan(declination_deg * DEG);
  return Math.acos(Math.min(1, Math.max(-1, cosine))) / (15 * DEG);
}

/** Hour of the day (solar time) at a share of the daylight: 0 before sunrise, 0.5 noon, 1 after sunset. */
export function hourOf(daytime: number, season: Season): number {
  const half = halfDay_h(SEASON_LOOKS[season].declination_deg);
  return 12 + (2 * daytime - 1) * (1 + 2 * TWILIGHT) * half;
}

/** "15:40". */
export function clockOf(daytime: number, season: Season): string {
  const minutes = Math.round((hourOf(daytime, season) * 60) / 5) * 5;
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")}`;
}

export function sunPlace(daytime: number, season: Season): SunPlace {
  const latitude = LATITUDE_DEG * DEG;
  const declination = SEASON_LOOKS[season].declination_deg * DEG;
  const turned = (hourOf(daytime, season) - 12) * 15 * DEG;
  const sine =
    Math.sin(latitude) * Math.sin(declination) +
    Math.cos(latitude) * Math.cos(declination) * Math.cos(turned);
  const west = Math.atan2(
    Math.sin(turned),
    Math.cos(turned) * Math.sin(latitude) - Math.tan(declination) * Math.cos(latitude),
  );
  return { azimuth_deg: 90 + west / DEG, elevation_deg: Math.asin(sine) / DEG };
}

export interface Atmosphere {
  readonly sun: SunPlace;
  readonly table: SkyTable;
  /** Sunlight on a surface that faces the sun. */
  readonly sunlight: Rgb;
  /** Sky light on level ground, including clouds. */
  readonly skylight: Rgb;
  /** Sunlight at the clouds. */
  readonly cloudlight: Rgb;
  readonly exposure: number;
  /** Extinction per metre. */
  readonly haze: Rgb;
  /** Extinction per metre at the base of the mist. */
  readonly mist: number;
  readonly clouds: number;
}

const times = (a: Rgb, k: number): Rgb => [a[0] * k, a[1] * k, a[2] * k];
const brightness = ([r, g, b]: Rgb) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const step = (from: number, to: number, x: number) => {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
};

/** Partial adaptation: dusk stays darker than noon but visible. */
function exposureFor(sun: Rgb, sky: Rgb, elevation_deg: number, snow: number): number {
  const level = Math.max(0.22, Math.sin(Math.max(0, elevation_deg) * DEG));
  const light = 0.55 * brightness(sun) * level + brightness(sky);
  return Math.min(3.6, 1.12 * (2.1 / light) ** 0.66) * (1 - 0.3 * snow);
}

/** Computes the lighting of one moment; takes several milliseconds. */
export function atmosphereAt(daytime: number, season: Season): Atmosphere {
  const look = SEASON_LOOKS[season];
  const sun = sunPlace(daytime, season);
  const elevation = sun.elevation_deg * DEG;
  const table = skyTable(elevation, look.haziness);
  const direct = times(sunlight(0, Math.sin(elevation), look.haziness), SUN_POWER);
  const clear = times(skyIrradiance(table, elevation), SUN_POWER);
  const cloudlight = times(sunlight(CLOUDS_M, Math.sin(elevation), look.haziness), SUN_POWER);
  // Clouds add light that is less blue than the clear sky.
  const cloudy = look.clouds * 0.16 * Math.max(0.1, Math.sin(elevation));
  const skylight: Rgb = [
    clear[0] + cloudy * cloudlight[0],
    clear[1] + cloudy * cloudlight[1],
    clear[2] + cloudy * cloudlight[2],
  ];
  const morning = 1 - step(0.1, 0.34, daytime);
  const dusk = step(0.9, 1, daytime);
  return {
    sun,
    table,
    sunlight: direct,
    skylight,
    cloudlight,
    exposure: exposureFor(direct, skylight, sun.elevation_deg, look.snow),
    haze: times([0.00042, 0.0006, 0.00092], 0.75 + 0.35 * look.haziness + 0.9 * morning + 0.3 * dusk),
    mist: 0.016 * look.mist * morning,
    clouds: look.clouds,
  };
}
