/** The wind document for what the visitor set. Pure. */
import type { Settings } from "./settings";
import type { WindDocument } from "./wind";

type WindSettings = Pick<Settings, "meanSpeed_m_s" | "direction_deg" | "gustiness" | "windSeed">;

/** Gusts travel with the mean wind, though never slower than a breath, so that calm has no standing waves. */
const SLOWEST_GUSTS_M_S = 2;

export function windDocument(settings: WindSettings): WindDocument {
  return {
    version: 1,
    model: "cosine",
    mean_speed_m_s: settings.meanSpeed_m_s,
    direction_deg: settings.direction_deg,
    gustiness: settings.gustiness,
    convection_speed_m_s: Math.max(SLOWEST_GUSTS_M_S, settings.meanSpeed_m_s),
    seed: settings.windSeed,
  };
}

/** Mean wind as a vector in the world's ground plane. */
export function windVector_m_s(settings: WindSettings): { x: number; z: number } {
  const heading = (settings.direction_deg * Math.PI) / 180;
  return { x: settings.meanSpeed_m_s * Math.cos(heading), z: settings.meanSpeed_m_s * Math.sin(heading) };
}
