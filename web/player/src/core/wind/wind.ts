/** The wind, specified in spec/formats/wind.md. */
import type { WindDocument } from "./document";
import { WindField } from "./field";
import type { Output, Places } from "./frame";
import { steady } from "./transition";

export { WIND_MODELS as MODELS } from "../constants";
export type { Wave, WindDocument, WindModel, WindNumber } from "./document";
export {
  FIELDS,
  hasField,
  parseWind,
  parseWindText,
  WIND_RANGES,
  WindError,
} from "./document";
export { WindField } from "./field";

export { CALM_BREEZE, PRESETS, type PresetName, paperWind } from "./presets";
export { dynamicPressure, heightFactor } from "./pressure";
export { EMPTY_RECORDING } from "./recording";
export { changeWind, finalWind, parseState, steady, type WindState, withFront } from "./transition";

let last: { wind: WindDocument; field: WindField } | undefined;

/**
 * Writes the pressure vector (Pa, world x and z) at each position x, z (m) and time t (s) in a constant wind document.
 * Exactly 0 in still air. `exponent`: that of the trees (`dynamicPressure`). A running forest uses a WindField instead.
 */
export function windPressure(
  wind: WindDocument,
  x: Places,
  z: Places,
  t: number,
  outX: Output,
  outZ: Output,
  exponent: number,
): void {
  if (!last) last = { wind, field: new WindField(wind) };
  if (last.wind !== wind) {
    last.wind = wind;
    last.field.state = steady(wind);
  }
  last.field.pressure(x, z, t, outX, outZ, exponent);
}
