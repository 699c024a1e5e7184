/** Longitude and latitude to metres about a point. Twin: precompute/galewood/inventory/projection.py. */

const EQUATOR_M = 6_378_137;
const FLATTENING = 1 / 298.257223563;
const E2 = FLATTENING * (2 - FLATTENING);
const radians = (degrees: number) => (degrees * Math.PI) / 180;

/** Metres to the east and to the north of an origin (°), by the radii of curvature of WGS 84 at the origin. */
export function local_m(
  lon_deg: number,
  lat_deg: number,
  origin: readonly [number, number],
): [number, number] {
  const phi = radians(origin[1]);
  const w2 = 1 - E2 * Math.sin(phi) * Math.sin(phi);
  const primeVertical = EQUATOR_M / Math.sqrt(w2);
  const meridian = (EQUATOR_M * (1 - E2)) / (w2 * Math.sqrt(w2));
  const turned = lon_deg - origin[0] + 540;
  const turn = turned - 360 * Math.floor(turned / 360) - 180;
  return [primeVertical * Math.cos(phi) * radians(turn), meridian * radians(lat_deg - origin[1])];
}
