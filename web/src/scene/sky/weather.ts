/** Clouds as a function of the wind, and what they do to the light. Pure. */
import type { Season } from "../season/season";
import type { Rgb } from "./atmosphere";

export interface Weather {
  /** Share of the sky covered by clouds. */
  readonly cover: number;
  /** Darkness of their undersides: 0 fair-weather clouds, 1 a storm. */
  readonly dark: number;
  /** Mean wind speed, m/s; wind scatters ground mist. */
  readonly speed_m_s: number;
}

/** Mean speeds (m/s) between which the cover and the darkness of the clouds grow; chosen by eye. */
const COVER_M_S = [4, 17] as const;
const DARK_M_S = [10, 20] as const;
const SNOW_M_S = [6, 16] as const;
/** Time constant of a change of weather, s: slower than the wind's own transition, so that clouds drift in. */
const CHANGE_S = 2.5;
const SETTLED_CHANGE = 0.002;
/** Share of direct sunlight that passes a cloud: fair-weather and closed cover. */
const SUNLIGHT_SHARES = { broken: 0.45, closed: 0.03 } as const;
/** Light that the clouds of a storm take away in addition. */
const STORM_LOSS = 0.45;

export const smoothstep = (from: number, to: number, x: number): number => {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
};
const mix = (a: number, b: number, share: number) => a + share * (b - a);

/** Weather that belongs to a mean wind speed; `fair`: cover in still air. */
export function weatherFor(speed_m_s: number, fair: number): Weather {
  return {
    cover: mix(fair, 1, smoothstep(...COVER_M_S, speed_m_s)),
    dark: smoothstep(...DARK_M_S, speed_m_s),
    speed_m_s,
  };
}

/** Share of the flakes of a snowstorm that are in the air; snow lies still in a breeze. */
export const snowShare = (speed_m_s: number, season: Season): number =>
  season === "winter" ? smoothstep(...SNOW_M_S, speed_m_s) : 0;

/** One step towards another weather; reaches it exactly, so that a still scene stops changing. */
export function easeWeather(from: Weather, to: Weather, dt_s: number): Weather {
  const share = 1 - Math.exp(-Math.max(0, dt_s) / CHANGE_S);
  const step = (a: number, b: number, settled: number) =>
    Math.abs(b - a) < settled && dt_s > 0 ? b : mix(a, b, share);
  return {
    cover: step(from.cover, to.cover, SETTLED_CHANGE),
    dark: step(from.dark, to.dark, SETTLED_CHANGE),
    speed_m_s: step(from.speed_m_s, to.speed_m_s, 20 * SETTLED_CHANGE),
  };
}

/** 0 while the blue sky shows between clouds, 1 when they close. */
export const closed = ({ cover }: Weather): number => smoothstep(0.7, 0.98, cover);

export interface SkyLight {
  /** Sunlight on a surface that faces the sun. */
  readonly sunlight: Rgb;
  /** Sky light on level ground. */
  readonly skylight: Rgb;
}

const brightness = ([r, g, b]: Rgb) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const map = (f: (c: 0 | 1 | 2) => number): Rgb => [f(0), f(1), f(2)];

/**
 * Sunlight and sky light below clouds. Global irradiance 1 − 0.75 n^3.4 and a diffuse share that grows with n², where n
 * is the cover (after Kasten and Czeplak 1980; coefficients unchecked). `behind`: how far a cloud hides the sun, 0 to 1.
 */
export function belowClouds(clear: SkyLight, sunSine: number, weather: Weather, behind: number): SkyLight {
  const level = Math.max(0.05, sunSine);
  const shut = closed(weather);
  const { cover: n } = weather;
  const loss = 1 - STORM_LOSS * weather.dark * shut;
  const through = mix(1, mix(SUNLIGHT_SHARES.broken, SUNLIGHT_SHARES.closed, shut), Math.max(behind, shut));
  const [sun, sky] = [brightness(clear.sunlight) * level, brightness(clear.skylight)];
  const all = (sun + sky) * (1 - 0.75 * n ** 3.4) * loss;
  const diffuse = all * mix(sky / Math.max(1e-9, sun + sky), 1, n * n);
  // Clouds scatter all colours alike: the light is that of sun and sky together, slightly bluish in a storm.
  const white = map((c) => clear.sunlight[c] * level + clear.skylight[c]);
  const tint = map((c) => white[c] / Math.max(1e-9, brightness(white)));
  const grey = map((c) => mix(1, tint[c], 0.6) * mix(1, [0.94, 1, 1.07][c], shut));
  return {
    sunlight: map((c) => clear.sunlight[c] * through * loss),
    skylight: map((c) => diffuse * mix(clear.skylight[c] / Math.max(1e-9, sky), grey[c], n * n)),
  };
}

/** Radiance of the CIE standard overcast sky by sine of the elevation, for an irradiance of 1 on level ground. */
export const overcastRadiance = (sine: number): number => ((9 / (7 * Math.PI)) * (1 + 2 * sine)) / 3;
