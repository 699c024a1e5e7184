/** Named winds: the six of the paper, and four presets of the page. */
import type { WindDocument } from "./document";

/** Peak speed / design speed, depth (U = peak (1 + depth cos) / (1 + depth)), period in s, phase in turns. */
const PAPER_WAVES = [
  [0.3, 0.5, 4, 0.5],
  [0.45, 0.9, 3, 0.5],
  [0.6, 0.3, 6, 0.6],
  [0.75, 0.7, 2.5, 0.45],
  [0.9, 0.3, 5, 0.55],
  [1, 0.8, 3.5, 0.5],
] as const;

/** The paper's wind k (0 … 5): one cosine wave in a constant direction. */
export function paperWind(k: number, designSpeed_m_s: number, direction_deg = 60): WindDocument {
  const [peak, depth, period_s, phase_turns] = PAPER_WAVES[k];
  return {
    version: 1,
    model: "cosine",
    mean_speed_m_s: (designSpeed_m_s * peak) / (1 + depth),
    direction_deg,
    gustiness: depth,
    convection_speed_m_s: 8,
    seed: 1,
    heading_swing_deg: 0,
    waves: [{ frequency_hz: 1 / period_s, share: 1, phase_turns }],
  };
}

const base = { version: 1, direction_deg: 30, seed: 1 } as const;

export const CALM_BREEZE: WindDocument = {
  ...base,
  model: "cosine",
  mean_speed_m_s: 8,
  gustiness: 0.5,
  convection_speed_m_s: 8,
};

export const PRESETS = {
  still: { ...base, model: "cosine", mean_speed_m_s: 0, gustiness: 0.5, convection_speed_m_s: 4 },
  breeze: {
    ...base,
    model: "perlin",
    mean_speed_m_s: 4,
    gustiness: 0.4,
    convection_speed_m_s: 4,
    length_scale_m: 18,
  },
  "autumn-gusts": {
    ...base,
    model: "spectral",
    mean_speed_m_s: 9,
    gustiness: 0.75,
    convection_speed_m_s: 10,
    length_scale_m: 28,
  },
  "storm-front": {
    ...base,
    model: "navier-stokes",
    mean_speed_m_s: 20,
    gustiness: 0.9,
    convection_speed_m_s: 16,
    length_scale_m: 34,
  },
} satisfies Record<string, WindDocument>;

export type PresetName = keyof typeof PRESETS;
