import type { WindDocument } from "../../web/player/src/core/wind/document";
import { WindField } from "../../web/player/src/core/wind/field";
import type { Output, Places } from "../../web/player/src/core/wind/frame";

/**
 * Writes the pressure (Pa, world x and z) on trees of a streamlined exponent at positions x, z (m) and a time (s) in a
 * constant wind.
 */
export function windPressure(
  wind: WindDocument,
  x: Places,
  z: Places,
  time_s: number,
  outX: Output,
  outZ: Output,
  exponent: number,
): void {
  const field = new WindField(wind);
  field.pressure(x, z, field.at(time_s), outX, outZ, exponent);
}
