/** Named winds: the six of the paper, and four presets of the page. */
import { PAPER_WAVES, WIND_PRESETS } from "../constants";
import type { WindDocument } from "./document";

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

export const CALM_BREEZE: WindDocument = {
  version: 1,
  model: "cosine",
  mean_speed_m_s: 8,
  direction_deg: 30,
  gustiness: 0.5,
  convection_speed_m_s: 8,
  seed: 1,
};

export type PresetName = keyof typeof WIND_PRESETS;
export const PRESETS: Readonly<Record<PresetName, WindDocument>> = WIND_PRESETS;
