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

const POINTS = ["east", "south-east", "south", "south-west", "west", "north-west", "north", "north-east"];

/** Compass point that the wind blows towards; −z is north. */
export function compassPoint(direction_deg: number): string {
  const turns = direction_deg / 360;
  return POINTS[Math.round((turns - Math.floor(turns)) * 8) % 8];
}

/** "7.0 m/s to the east: Beaufort 4, moderate breeze". */
export function windInWords(speed_m_s: number, direction_deg: number): string {
  const { force, name } = beaufort(speed_m_s);
  const strength = `Beaufort ${force}, ${name}`;
  if (force === 0) return `Still air: ${strength}`;
  return `${speed_m_s.toFixed(1)} m/s to the ${compassPoint(direction_deg)}: ${strength}`;
}
