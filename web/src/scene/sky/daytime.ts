/** Light of the scene by season and time of day. Pure. */

import { SEASON_LOOKS, type Season } from "../season/season";
import { type Rgb, type SkyTable, skyIrradiance, skyTable, sunlight } from "./atmosphere";
import { belowClouds, closed, smoothstep, snowShare, type Weather } from "./weather";

const LATITUDE_DEG = 47;
/** Sunlight above the atmosphere, in the renderer's units. */
export const SUN_POWER = 5.6;
/** A daytime of 0 is this share of the day before sunrise, one of 1 as long after sunset. */
const TWILIGHT_DAY_SHARE = 0.015;
/** Limits of the daytime: from night to night, in every season. */
export const DAYTIMES = { min: -0.2, max: 1.2, step: 0.005 } as const;
/** Height of the clouds, for their lighting. */
const CLOUDS_M = 2500;
const RAD_PER_DEG = Math.PI / 180;
const CLEAR_WEATHER: Weather = { cover: 0, dark: 0, speed_m_s: 0 };
/** Elevation of the sun below which the moon lights the scene: the afterglow is gone, over half an hour after sunset. */
const NIGHT_DEG = -5.6;
/** Elevation of the sun below which colours fade, until it is night. */
const COLOURS_FROM_DEG = -2.5;
/** Light of the moon relative to sunlight: far more than a moon has, and bluer, as the eye sees a night. */
const MOON_POWER: Rgb = [0.017, 0.022, 0.03];
/** How much higher the moon stands than opposite the sun, so that it lights the ground. */
const MOON_RAISE_DEG = 18;
/** A storm looks hazier than its light alone makes it. */
const STORM_HAZE = 2.6;
/** Extinction of red, green and blue light by the air: at noon one sees about 17 km (3.9 over that of green, Koschmieder 1924). */
const EXTINCTION_PER_M: Rgb = [0.00018, 0.00026, 0.00042];
/** Extinction of the densest morning mist at its base, per metre. */
const DENSE_MIST = 0.016;
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

/** Hour of the day (solar time) at a share of the daylight: 0 before sunrise, 0.5 noon, 1 after sunset; night beyond. */
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
  /** Where the light comes from: the sun, at night the moon. */
  readonly sun: SunPlace;
  readonly table: SkyTable;
  /** Sunlight on a surface that faces the sun. */
  readonly sunlight: Rgb;
  /** Sky light on level ground, including clouds. */
  readonly skylight: Rgb;
  /** Sunlight at the clouds. */
  readonly cloudlight: Rgb;
  readonly exposure: number;
  /** Light that the exposure shows at least, in the unit of `exposureFor`. */
  readonly shownLight: number;
  /** How far eyes see as by night: 0 by day, 1 by night. */
  readonly nightVision: number;
  /** Extinction per metre. */
  readonly haze: Rgb;
  /** Extinction per metre at the base of the mist. */
  readonly mist: number;
  readonly weather: Weather;
}

const times = (a: Rgb, k: number): Rgb => [a[0] * k, a[1] * k, a[2] * k];
const product = (a: Rgb, b: Rgb): Rgb => [a[0] * b[0], a[1] * b[1], a[2] * b[2]];
const plus = (a: Rgb, k: number): Rgb => [a[0] + k, a[1] + k, a[2] + k];
const brightness = ([r, g, b]: Rgb) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

/** Least light shown, by day and twilight under any clouds, and at night: pictures are never black. */
const LEAST_SHOWN = { day: 1.25, night: 0.85 } as const;
/** More of it below a closed cover by day, where a wood has no bright spots. */
const MORE_UNDER_CLOUDS = 0.42;

/**
 * Exposure for the light of sun and sky. The adaptation is partial, so that dusk and storms stay darker than noon, down to
 * the light `least`, below which it is complete.
 */
export function exposureFor(sun: Rgb, sky: Rgb, elevation_deg: number, least: number): number {
  const level = Math.max(0.1, Math.sin(Math.max(0, elevation_deg) * RAD_PER_DEG));
  const light = 0.55 * brightness(sun) * level + brightness(sky);
  return Math.max(least, 1.2 * light * (2.1 / light) ** 0.66) / light;
}

/** What is taken off the exposure where everything is white: in snow and in mist. */
const inWhite = (snow: number, mistiness: number) => (1 - 0.65 * snow) * (1 - 0.5 * mistiness);

/** A full moon, opposite the sun but higher. */
const moonPlace = ({ azimuth_deg, elevation_deg }: SunPlace): SunPlace => ({
  azimuth_deg: (azimuth_deg + 180) % 360,
  elevation_deg: MOON_RAISE_DEG - elevation_deg,
});

/** A table in the light of the moon. */
const moonlit = (table: SkyTable): SkyTable => ({
  ...table,
  light: table.light.map((value, k) => value * MOON_POWER[k % 3]),
});

/** Computes the lighting of one moment below a clear sky; takes several milliseconds. */
export function atmosphereAt(daytime: number, season: Season): Atmosphere {
  const look = SEASON_LOOKS[season];
  const day = sunPlace(daytime, season);
  const night = day.elevation_deg < NIGHT_DEG;
  const sun = night ? moonPlace(day) : day;
  const elevation = sun.elevation_deg * RAD_PER_DEG;
  const clearTable = skyTable(elevation, look.haziness);
  const table = night ? moonlit(clearTable) : clearTable;
  const power: Rgb = night ? times(MOON_POWER, SUN_POWER) : [SUN_POWER, SUN_POWER, SUN_POWER];
  const at = (height_m: number) => product(sunlight(height_m, Math.sin(elevation), look.haziness), power);
  const direct = at(0);
  const clear = times(skyIrradiance(table, elevation), SUN_POWER);
  const cloudlight = at(CLOUDS_M);
  const shownLight = night ? LEAST_SHOWN.night : LEAST_SHOWN.day;
  const morning = 1 - smoothstep(0.1, 0.34, daytime);
  const dusk = smoothstep(0.9, 1, daytime);
  return {
    sun,
    table,
    sunlight: direct,
    skylight: clear,
    cloudlight,
    exposure: exposureFor(direct, clear, sun.elevation_deg, shownLight),
    shownLight,
    nightVision: 1 - smoothstep(NIGHT_DEG, COLOURS_FROM_DEG, day.elevation_deg),
    haze: times(EXTINCTION_PER_M, 0.75 + 0.35 * look.haziness + 2.2 * morning + 1.5 * dusk),
    mist: DENSE_MIST * look.mist * morning,
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
  const misty = mist * (1 - smoothstep(3, 9, weather.speed_m_s));
  const more = 1 + MORE_UNDER_CLOUDS * closed(weather) * (1 - clear.nightVision);
  const adapted = exposureFor(lit.sunlight, lit.skylight, sun.elevation_deg, more * clear.shownLight);
  return {
    ...clear,
    ...lit,
    weather,
    exposure: adapted * inWhite(snow * (1 - 0.5 * closed(weather)), misty / DENSE_MIST),
    haze: plus(times(haze, 1 + STORM_HAZE * weather.dark), SNOW_HAZE * snowShare(weather.speed_m_s, season)),
    mist: misty,
  };
}
