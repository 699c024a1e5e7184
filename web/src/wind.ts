// The wind field: the same arithmetic as precompute/wind.py. docs/formats/wind.md is the specification.

export interface WindDocument {
  readonly version: 1;
  readonly model: "cosine";
  readonly mean_speed_m_s: number;
  readonly direction_deg: number;
  readonly gustiness: number;
  readonly convection_speed_m_s: number;
  readonly seed: number;
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

export class WindError extends Error {
  override readonly name = "WindError";
}

const AIR_DENSITY_KG_M3 = 1.2;
const STREAMLINING_SPEED_M_S = 5;
const STREAMLINED_EXPONENT = 1.3;
const COMPONENT_HZ = [0.05, 0.087, 0.152, 0.264, 0.46, 0.8];
const COMPONENT_SHARE = [0.262, 0.218, 0.181, 0.15, 0.105, 0.084];
const CROSSWIND_SHARE = [0.6, -0.45, 0.75, -0.6, 0.5, -0.7];
const HEADING_HZ = 0.03;
const DEGREE = Math.PI / 180;
const HEADING_SWING_RAD = 12 * DEGREE;

type NumericField = "mean_speed_m_s" | "direction_deg" | "gustiness" | "convection_speed_m_s" | "seed";

export const WIND_RANGES: Readonly<Record<NumericField, readonly [number, number]>> = {
  mean_speed_m_s: [0, 60],
  direction_deg: [-360, 360],
  gustiness: [0, 1],
  convection_speed_m_s: [0.5, 60],
  seed: [0, 4294967295],
};

/** Reads a wind document; throws WindError naming the offending field and its range. */
export function parseWind(value: unknown): WindDocument {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    throw new WindError("wind: expected an object");
  }
  const fields = value as Record<string, unknown>;
  for (const name of Object.keys(fields)) {
    if (!(name in WIND_RANGES) && name !== "version" && name !== "model") {
      throw new WindError(`wind.${name.slice(0, 40)}: unknown field`);
    }
  }
  if (fields.version !== 1) {
    throw new WindError(`wind.version: this reader knows version 1, not ${String(fields.version)}`);
  }
  if (fields.model !== "cosine") throw new WindError('wind.model: expected "cosine"');
  const seed = numberField(fields, "seed");
  if (!Number.isInteger(seed)) throw new WindError("wind.seed: expected a whole number in 0..4294967295");
  return {
    version: 1,
    model: "cosine",
    mean_speed_m_s: numberField(fields, "mean_speed_m_s"),
    direction_deg: numberField(fields, "direction_deg"),
    gustiness: numberField(fields, "gustiness"),
    convection_speed_m_s: numberField(fields, "convection_speed_m_s"),
    seed,
  };
}

function numberField(fields: Record<string, unknown>, name: NumericField): number {
  const [low, high] = WIND_RANGES[name];
  const value = fields[name];
  const expected = `expected a number in ${low}..${high}`;
  if (value === undefined) throw new WindError(`wind.${name}: missing, ${expected}`);
  if (typeof value !== "number" || !(value >= low && value <= high)) {
    throw new WindError(`wind.${name}: ${expected}, not ${String(value).slice(0, 40)}`);
  }
  return value;
}

/** Phase of a component from a 32-bit hash (Mueller's integer finaliser) of (seed, component). */
export function phaseRad(seed: number, component: number): number {
  let h = (seed + Math.imul(0x9e3779b9, component + 1)) >>> 0;
  for (let round = 0; round < 2; round++) h = Math.imul(h ^ (h >>> 16), 0x45d9f3b) >>> 0;
  return ((h ^ (h >>> 16)) >>> 0) * ((2 * Math.PI) / 4294967296);
}

/** Effective dynamic pressure (Pa): ½ρU² up to 5 m/s, growing as U^1.3 beyond (streamlining). */
export function dynamicPressure(speedMS: number): number {
  if (speedMS <= STREAMLINING_SPEED_M_S) return 0.5 * AIR_DENSITY_KG_M3 * speedMS * speedMS;
  const start = 0.5 * AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S * STREAMLINING_SPEED_M_S;
  return start * (speedMS / STREAMLINING_SPEED_M_S) ** STREAMLINED_EXPONENT;
}

const phases = new Float64Array(7);

/**
 * Writes the pressure vector (Pa, world x and z) at each place x, z (m) at time t (s).
 * Exactly 0 where the wind is still. Allocates nothing.
 */
export function windPressure(
  wind: WindDocument,
  x: ArrayLike<number>,
  z: ArrayLike<number>,
  t: number,
  outX: Float32Array,
  outZ: Float32Array,
): void {
  for (let k = 0; k < 7; k++) phases[k] = phaseRad(wind.seed, k);
  const direction = wind.direction_deg * DEGREE;
  const c = Math.cos(direction);
  const s = Math.sin(direction);
  for (let i = 0; i < outX.length; i++) {
    const age = t - (c * x[i] + s * z[i]) / wind.convection_speed_m_s;
    const across = (c * z[i] - s * x[i]) / wind.convection_speed_m_s;
    const speed = wind.mean_speed_m_s * Math.max(0, 1 + wind.gustiness * rippleAt(age, across));
    const swing = Math.cos(2 * Math.PI * HEADING_HZ * (age + 0.5 * across) + phases[6]);
    const heading = direction + wind.gustiness * HEADING_SWING_RAD * swing;
    const pressure = dynamicPressure(speed);
    outX[i] = pressure * Math.cos(heading);
    outZ[i] = pressure * Math.sin(heading);
  }
}

function rippleAt(age: number, across: number): number {
  let ripple = 0;
  for (let k = 0; k < 6; k++) {
    const omega = 2 * Math.PI * COMPONENT_HZ[k];
    ripple += COMPONENT_SHARE[k] * Math.cos(omega * (age + CROSSWIND_SHARE[k] * across) + phases[k]);
  }
  return ripple;
}
