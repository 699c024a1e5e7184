/** Light of the scene by season and time of day. Pure. */

import { SEASON_LOOKS, type Season } from "../season/season";
import { type Rgb, type SkyTable, skyIrradiance, skyTable, sunlight } from "./atmosphere";
import { belowClouds, closed, smoothstep, snowShare, type Weather } from "./weather";

const LATITUDE_DEG = 47;
/** Sunlight above the atmosphere, in the renderer's units. */
export const SUN_POWER = 5.6;
/** The ends of the slider are this share of the day before sunrise and after sunset (twilight). */
const TWILIGHT_DAY_SHARE = 0.015;
/** Height of the clouds, for their lighting. */
const CLOUDS_M = 2500;
const RAD_PER_DEG = Math.PI / 180;
const CLEAR_WEATHER: Weather = { cover: 0, dark: 0, speed_m_s: 0 };
/** A storm looks darker and hazier than its light alone makes it. */
const STORM_EXPOSURE = 0.12;
const STORM_HAZE = 1.1;
/** Extinction of driven snow per metre, the same for all colours: visibility of some hundred metres. */
const SNOW_HAZE = 0.006;
/** Gain of the light between snow on the ground and a closed cover, which reflect it to and fro. */
const SNOW_GAIN = 0.5;

export interface SunPlace {
  /** 0 = +x (east), 90 = +z (south). */
  readonly azimuth_deg: number;
  readonly elevation_deg: number;
}

/** Hours from noon to sunset. */
export function halfDay_h(declination_deg: number): number {
  const cosine = -Math.tan(LATITUDE_DEG * RAD_PER_DEG) * Math.tan(declination_deg * RAD_PER_DEG);
  return Math.acos(Math.min(1, Math.max(-1, cosine))) / (15 * RAD_PER_DEG);
}

/** Hour of the day (solar time) at a share of the daylight: 0 before sunrise, 0.5 noon, 1 after sunset. */
export function hourOf(daytime: number, season: Season): number {
  const half = halfDay_h(SEASON_LOOKS[season].declination_deg);
  return 12 + (2 * daytime - 1) * (1 + 2 * TWILIGHT_DAY_SHARE) * half;
}

/** "15:40". */
export function clockOf(daytime: number, season: Season): string {
  const minutes = Math.round((hourOf(daytime, season) * 60) / 5) * 5;
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")}`;
}

export function sunPlace(daytime: number, season: Season): SunPlace {
  const latitude = LATITUDE_DEG * RAD_PER_DEG;
  const declination = SEASON_LOOKS[season].declination_deg * RAD_PER_DEG;
  const turned = (hourOf(daytime, season) - 12) * 15 * RAD_PER_DEG;
  const sine =
    Math.sin(latitude) * Math.sin(declination) +
    Math.cos(latitude) * Math.cos(declination) * Math.cos(turned);
  const west = Math.atan2(
    Math.sin(turned),
    Math.cos(turned) * Math.sin(latitude) - Math.tan(declination) * Math.cos(latitude),
  );
  return { azimuth_deg: 90 + west / RAD_PER_DEG, elevation_deg: Math.asin(sine) / RAD_PER_DEG };
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
  readonly weather: Weather;
}

const times = (a: Rgb, k: number): Rgb => [a[0] * k, a[1] * k, a[2] * k];
const plus = (a: Rgb, k: number): Rgb => [a[0] + k, a[1] + k, a[2] + k];
const brightness = ([r, g, b]: Rgb) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

/** Partial adaptation: dusk stays darker than noon but visible. */
function exposureFor(sun: Rgb, sky: Rgb, elevation_deg: number, snow: number): number {
  const level = Math.max(0.22, Math.sin(Math.max(0, elevation_deg) * RAD_PER_DEG));
  const light = 0.55 * brightness(sun) * level + brightness(sky);
  return Math.min(3.6, 1.12 * (2.1 / light) ** 0.66) * (1 - 0.3 * snow);
}

/** Computes the lighting of one moment below a clear sky; takes several milliseconds. */
export function atmosphereAt(daytime: number, season: Season): Atmosphere {
  const look = SEASON_LOOKS[season];
  const sun = sunPlace(daytime, season);
  const elevation = sun.elevation_deg * RAD_PER_DEG;
  const table = skyTable(elevation, look.haziness);
  const direct = times(sunlight(0, Math.sin(elevation), look.haziness), SUN_POWER);
  const clear = times(skyIrradiance(table, elevation), SUN_POWER);
  const cloudlight = times(sunlight(CLOUDS_M, Math.sin(elevation), look.haziness), SUN_POWER);
  const morning = 1 - smoothstep(0.1, 0.34, daytime);
  const dusk = smoothstep(0.9, 1, daytime);
  return {
    sun,
    table,
    sunlight: direct,
    skylight: clear,
    cloudlight,
    exposure: exposureFor(direct, clear, sun.elevation_deg, look.snow),
    haze: times([0.00042, 0.0006, 0.00092], 0.75 + 0.35 * look.haziness + 0.9 * morning + 0.3 * dusk),
    mist: 0.016 * look.mist * morning,
    weather: CLEAR_WEATHER,
  };
}

/** The same moment below clouds; cheap. `behind`: how far a cloud hides the sun, 0 to 1. */
export function underClouds(clear: Atmosphere, season: Season, weather: Weather, behind: number): Atmosphere {
  const { sun, skylight, haze, mist } = clear;
  const sine = Math.sin(sun.elevation_deg * RAD_PER_DEG);
  const { snow } = SEASON_LOOKS[season];
  const below = belowClouds({ sunlight: clear.sunlight, skylight }, sine, weather, behind);
  const lit = { ...below, skylight: times(below.skylight, 1 + SNOW_GAIN * snow * closed(weather)) };
  const base = exposureFor(lit.sunlight, lit.skylight, sun.elevation_deg, snow * (1 - closed(weather)));
  return {
    ...clear,
    ...lit,
    weather,
    exposure: base * (1 - STORM_EXPOSURE * weather.dark * closed(weather)),
    haze: plus(times(haze, 1 + STORM_HAZE * weather.dark), SNOW_HAZE * snowShare(weather.speed_m_s, season)),
    mist: mist * (1 - smoothstep(3, 9, weather.speed_m_s)),
  };
}
