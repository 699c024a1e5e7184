/** Text descriptions of a wind. Pure. */

/** The Beaufort scale of the World Meteorological Organization: names, and upper limits of the mean speed in m/s. */
const FORCES = [
  ["calm", 0.3],
  ["light air", 1.6],
  ["light breeze", 3.4],
  ["gentle breeze", 5.5],
  ["moderate breeze", 8],
  ["fresh breeze", 10.8],
  ["strong breeze", 13.9],
  ["near gale", 17.2],
  ["gale", 20.8],
  ["strong gale", 24.5],
  ["storm", 28.5],
  ["violent storm", 32.7],
  ["hurricane", Number.POSITIVE_INFINITY],
] as const;

export function beaufort(speed_m_s: number): { force: number; name: string } {
  const force = FORCES.findIndex(([, end]) => speed_m_s < end);
  return { force, name: FORCES[force][0] };
}

const POINTS = ["north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west"];

/**
 * The bearing that a wind comes from, as forecasts give it: 0° north, 90° east. `direction_deg` is the direction that it
 * blows towards, from x (east) to z (south).
 */
export function bearingFrom_deg(direction_deg: number): number {
  const bearing = direction_deg + 270;
  return bearing - 360 * Math.floor(bearing / 360);
}

/** The direction of a wind that comes from a bearing. */
export const directionFrom_deg = (bearing_deg: number): number => {
  const direction = bearing_deg - 270;
  return direction - 360 * Math.floor(direction / 360);
};

/** "north-westerly": compass point that the wind comes from. */
export function windName(direction_deg: number): string {
  return `${POINTS[Math.round(bearingFrom_deg(direction_deg) / 45) % 8]}erly`;
}

/** "North-westerly, 7 m/s: moderate breeze (Beaufort 4)". */
export function windInWords(speed_m_s: number, direction_deg: number): string {
  const { force, name } = beaufort(speed_m_s);
  const strength = `${name} (Beaufort ${force})`;
  if (force === 0) return `Still air: ${strength}`;
  const from = windName(direction_deg);
  return `${from.charAt(0).toUpperCase()}${from.slice(1)}, ${Number(speed_m_s.toFixed(1))} m/s: ${strength}`;
}
