/** The wind: the same arithmetic as precompute/galewood/wind/. docs/formats/wind.md is the specification. */
import type { WindDocument } from "./document";
import { WindField } from "./field";
import type { Output, Places } from "./frame";
import { steady } from "./glide";

export type { Wave, WindDocument, WindModel, WindNumber } from "./document";
export { FIELDS, hasField, MODELS, parseWind, resolveWind, WIND_RANGES, WindError } from "./document";
export { WindField } from "./field";
export { changeWind, parseState, steady, type WindState, windAt } from "./glide";
export { phaseRad } from "./hashing";
export { CALM_BREEZE, PRESETS, type PresetName, paperWind } from "./presets";
export { coverage, dynamicPressure, heightFactor, limitPressure, sampledPeak } from "./pressure";

let last: { wind: WindDocument; field: WindField } | undefined;

/**
 * Writes the pressure vector (Pa, world x and z) at each place x, z (m) at time t (s) in a wind that has always
 * been this one. Exactly 0 where the wind is still. A running forest keeps a WindField instead.
 */
export function windPressure(
  wind: WindDocument,
  x: Places,
  z: Places,
  t: number,
  outX: Output,
  outZ: Output,
): void {
  if (!last) last = { wind, field: new WindField(wind) };
  if (last.wind !== wind) {
    last.wind = wind;
    last.field.state = steady(wind);
  }
  last.field.pressure(x, z, t, outX, outZ);
}
