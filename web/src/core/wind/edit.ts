/** The wind document for what the visitor set. Pure. */
import type { Settings } from "../../page/settings/settings";
import type { WindDocument } from "./wind";

type WindSettings = Pick<Settings, "meanSpeed_m_s" | "direction_deg" | "gustiness" | "windSeed" | "wind">;

/** Gusts travel with the mean wind, though never slower than a breath, so that calm has no standing waves. */
const SLOWEST_GUSTS_M_S = 2;

export const gustSpeed_m_s = (mean_m_s: number): number => Math.max(SLOWEST_GUSTS_M_S, mean_m_s);

/** Another mean; the gusts' speed follows where it followed before. */
export function withMean(wind: WindDocument, mean_speed_m_s: number, direction_deg: number): WindDocument {
  const follows = wind.convection_speed_m_s === gustSpeed_m_s(wind.mean_speed_m_s);
  const convection_speed_m_s = follows ? gustSpeed_m_s(mean_speed_m_s) : wind.convection_speed_m_s;
  return { ...wind, mean_speed_m_s, direction_deg, convection_speed_m_s };
}

export function windDocument(settings: WindSettings): WindDocument {
  return {
    version: 1,
    model: "cosine",
    convection_speed_m_s: gustSpeed_m_s(settings.meanSpeed_m_s),
    ...settings.wind,
    mean_speed_m_s: settings.meanSpeed_m_s,
    direction_deg: settings.direction_deg,
    gustiness: settings.gustiness,
    seed: settings.windSeed,
  };
}

/** Mean wind as a vector in the world's ground plane. */
export function windVector_m_s(settings: WindSettings): { x: number; z: number } {
  const heading = (settings.direction_deg * Math.PI) / 180;
  return { x: settings.meanSpeed_m_s * Math.cos(heading), z: settings.meanSpeed_m_s * Math.sin(heading) };
}
