/** The views of the forest in docs/images. */

type Place = { x: number; above: number; z: number };

export interface Shot {
  readonly season: "spring" | "summer" | "autumn" | "winter";
  readonly daytime: number;
  readonly eye: Place;
  readonly at: Place;
  readonly wind?: object;
  /** Time before the picture is taken, s. */
  readonly after_s: number;
}

const STORM_WIND = {
  version: 1,
  direction_deg: 20,
  seed: 1,
  model: "navier-stokes",
  mean_speed_m_s: 21,
  gustiness: 0.9,
  convection_speed_m_s: 20,
  length_scale_m: 40,
};

const EDGE_VIEW = { eye: { x: 7, above: 8.2, z: 24 }, at: { x: -1, above: 6.2, z: -16 } };
const LOW_VIEW = { eye: { x: 5, above: 3.6, z: 10 }, at: { x: -1, above: 6, z: -14 } };

export const SHOTS: Readonly<Record<string, Shot>> = {
  "autumn-noon": { season: "autumn", daytime: 0.6, ...EDGE_VIEW, after_s: 1 },
  "autumn-sunset": { season: "autumn", daytime: 0.955, ...LOW_VIEW, after_s: 1 },
  winter: { season: "winter", daytime: 0.3, ...EDGE_VIEW, after_s: 1 },
  summer: {
    season: "summer",
    daytime: 0.42,
    eye: { x: 2, above: 1.9, z: -2 },
    at: { x: -9, above: 6.5, z: -24 },
    after_s: 1,
  },
  storm: { season: "autumn", daytime: 0.72, ...LOW_VIEW, wind: STORM_WIND, after_s: 8 },
};
