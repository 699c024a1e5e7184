/**
 * Light of a clear sky: single scattering, with an isotropic term for multiple scattering. Rayleigh and aerosol
 * scattering and ozone after Hillaire, A Scalable and Production Ready Sky and Atmosphere
 * Rendering Technique (2020), table 1. Pure; all light is relative to sunlight above the atmosphere.
 */

export type Rgb = readonly [number, number, number];

const GROUND_M = 6_360_000;
const TOP_M = 6_460_000;
/** Coefficients per metre at sea level for red, green and blue. */
const RAYLEIGH_PER_M: Rgb = [5.802e-6, 13.558e-6, 33.1e-6];
const OZONE_PER_M: Rgb = [0.65e-6, 1.881e-6, 0.085e-6];
const AEROSOL_PER_M = { scattered: 3.996e-6, absorbed: 0.44e-6 } as const;
const SCALE_M = { rayleigh: 8000, aerosol: 1200 } as const;
/** Multiply scattered light per steradian and unit of sunlight. */
const MULTIPLE_SCATTERING = 0.075;
const EYE_M = 120;

const TO_SUN_STEPS = 32;
const VIEW_STEPS = 28;

interface Air {
  readonly rayleigh: number;
  readonly aerosol: number;
  readonly ozone: number;
}

function airAt(height_m: number, haziness: number): Air {
  const h = Math.max(0, height_m);
  return {
    rayleigh: Math.exp(-h / SCALE_M.rayleigh),
    aerosol: haziness * Math.exp(-h / SCALE_M.aerosol),
    ozone: Math.max(0, 1 - Math.abs(h - 25_000) / 15_000),
  };
}

const extinction = ({ rayleigh, aerosol, ozone }: Air, c: number) =>
  RAYLEIGH_PER_M[c] * rayleigh +
  (AEROSOL_PER_M.scattered + AEROSOL_PER_M.absorbed) * aerosol +
  OZONE_PER_M[c] * ozone;

/** Distance from a height to the top of the atmosphere, by sine of the elevation. */
function wayOut_m(height_m: number, sine: number): number {
  const r = GROUND_M + height_m;
  return -r * sine + Math.sqrt(Math.max(0, r * r * (sine * sine - 1) + TOP_M * TOP_M));
}

const heightAfter_m = (height_m: number, sine: number, way_m: number) => {
  const r = GROUND_M + height_m;
  return Math.sqrt(r * r + way_m * way_m + 2 * r * way_m * sine) - GROUND_M;
};

/** Transmittance of sunlight to a height; fades out when the sun is behind the earth. */
export function sunlight(height_m: number, sunSine: number, haziness: number): [number, number, number] {
  const r = GROUND_M + height_m;
  const dip = -Math.sqrt(Math.max(0, 1 - (GROUND_M / r) ** 2));
  const risen = Math.min(1, Math.max(0, (sunSine - dip + 0.012) / 0.024));
  const sine = Math.max(sunSine, dip);
  const way_m = wayOut_m(height_m, sine);
  const depth = [0, 0, 0];
  for (let k = 0; k < TO_SUN_STEPS; k++) {
    // Steps grow with distance, because most of the air is near.
    const from = (k / TO_SUN_STEPS) ** 2 * way_m;
    const to = ((k + 1) / TO_SUN_STEPS) ** 2 * way_m;
    const air = airAt(heightAfter_m(height_m, sine, 0.5 * (from + to)), haziness);
    for (let c = 0; c < 3; c++) depth[c] += extinction(air, c) * (to - from);
  }
  return [risen * Math.exp(-depth[0]), risen * Math.exp(-depth[1]), risen * Math.exp(-depth[2])];
}

/** Sunlight by height for one position of the sun, cached for all view rays. */
function sunlightByHeight(sunSine: number, haziness: number) {
  const LAYERS = 48;
  const rows = Array.from({ length: LAYERS + 1 }, (_, k) =>
    sunlight((k / LAYERS) ** 2 * (TOP_M - GROUND_M), sunSine, haziness),
  );
  return (height_m: number, c: number) => {
    const at = Math.min(LAYERS - 1e-6, LAYERS * Math.sqrt(Math.max(0, height_m) / (TOP_M - GROUND_M)));
    const k = Math.floor(at);
    return rows[k][c] + (at - k) * (rows[k + 1][c] - rows[k][c]);
  };
}

export interface SkyTable {
  readonly azimuths: number;
  readonly elevations: number;
  /** [2, elevations, azimuths, 3]: scattered by air, then by aerosols without their phase function. */
  readonly light: Float32Array;
}

export const SKY_AZIMUTHS = 24;
export const SKY_ELEVATIONS = 40;

/** Sine of the elevation of a row; rows are spaced by its square root, fine at the horizon. */
export const elevationOf_rad = (row: number) => (row / (SKY_ELEVATIONS - 1)) ** 2 * 0.5 * Math.PI;
/** Azimuth of a column relative to the sun; columns are spaced by the sine of half the angle. */
const azimuthOf_rad = (column: number) => 2 * Math.asin(column / (SKY_AZIMUTHS - 1));

const rayleighPhase = (cosine: number) => (3 / (16 * Math.PI)) * (1 + cosine * cosine);

/** Henyey–Greenstein phase function of aerosols; same as in the shader. */
export const AEROSOL_G = 0.74;
export function aerosolPhase(cosine: number): number {
  const g2 = AEROSOL_G * AEROSOL_G;
  return (1 - g2) / (4 * Math.PI * (1 + g2 - 2 * AEROSOL_G * cosine) ** 1.5);
}

/** Computes the sky for one position of the sun. `haziness` 1 is clean air. */
export function skyTable(sunElevation_rad: number, haziness: number): SkyTable {
  const sunSine = Math.sin(sunElevation_rad);
  const sun = sunlightByHeight(sunSine, haziness);
  const above = sunlightByHeight(Math.max(0.02, sunSine) + 0.1, haziness);
  const lit = Math.min(1, Math.max(0, (sunSine + 0.1) / 0.14));
  const light = new Float32Array(2 * SKY_ELEVATIONS * SKY_AZIMUTHS * 3);
  for (let row = 0; row < SKY_ELEVATIONS; row++) {
    const elevation = elevationOf_rad(row);
    const ray = viewRay(Math.sin(elevation), haziness, sun, (h, c) => lit * above(h, c));
    for (let column = 0; column < SKY_AZIMUTHS; column++) {
      const cosine =
        Math.cos(elevation) * Math.cos(sunElevation_rad) * Math.cos(azimuthOf_rad(column)) +
        Math.sin(elevation) * sunSine;
      const at = (row * SKY_AZIMUTHS + column) * 3;
      for (let c = 0; c < 3; c++) {
        light[at + c] = rayleighPhase(cosine) * ray.rayleigh[c] + ray.again[c];
        light[light.length / 2 + at + c] = ray.aerosol[c];
      }
    }
  }
  return { azimuths: SKY_AZIMUTHS, elevations: SKY_ELEVATIONS, light };
}

type ByHeight = (height_m: number, channel: number) => number;

/** Light scattered towards the eye along one ray, by kind and without the phase function. */
function viewRay(sine: number, haziness: number, sun: ByHeight, above: ByHeight) {
  const way_m = wayOut_m(EYE_M, sine);
  const out = { rayleigh: [0, 0, 0], aerosol: [0, 0, 0], again: [0, 0, 0] };
  const clear = [1, 1, 1];
  for (let k = 0; k < VIEW_STEPS; k++) {
    const from = (k / VIEW_STEPS) ** 2 * way_m;
    const to = ((k + 1) / VIEW_STEPS) ** 2 * way_m;
    const height_m = heightAfter_m(EYE_M, sine, 0.5 * (from + to));
    const air = airAt(height_m, haziness);
    for (let c = 0; c < 3; c++) {
      const lost = extinction(air, c);
      const passed = Math.exp(-lost * (to - from));
      const seen = clear[c] * (lost > 0 ? (1 - passed) / lost : to - from);
      const scattered = RAYLEIGH_PER_M[c] * air.rayleigh;
      const dust = AEROSOL_PER_M.scattered * air.aerosol;
      out.rayleigh[c] += seen * scattered * sun(height_m, c);
      out.aerosol[c] += seen * dust * sun(height_m, c);
      out.again[c] += seen * (scattered + dust) * MULTIPLE_SCATTERING * above(height_m, c);
      clear[c] *= passed;
    }
  }
  return out;
}

/** Irradiance of the sky on level ground, integrated over the table. */
export function skyIrradiance(table: SkyTable, sunElevation_rad: number): [number, number, number] {
  const { light } = table;
  const sum: [number, number, number] = [0, 0, 0];
  for (let row = 0; row + 1 < SKY_ELEVATIONS; row++) {
    const low = elevationOf_rad(row);
    const high = elevationOf_rad(row + 1);
    const middle = 0.5 * (low + high);
    for (let column = 0; column + 1 < SKY_AZIMUTHS; column++) {
      const width = azimuthOf_rad(column + 1) - azimuthOf_rad(column);
      const azimuth = 0.5 * (azimuthOf_rad(column + 1) + azimuthOf_rad(column));
      const solid = 2 * width * (Math.sin(high) - Math.sin(low));
      const cosine =
        Math.cos(middle) * Math.cos(sunElevation_rad) * Math.cos(azimuth) +
        Math.sin(middle) * Math.sin(sunElevation_rad);
      const at = (row * SKY_AZIMUTHS + column) * 3;
      for (let c = 0; c < 3; c++) {
        const radiance = light[at + c] + aerosolPhase(cosine) * light[light.length / 2 + at + c];
        sum[c] += radiance * Math.sin(middle) * solid;
      }
    }
  }
  return sum;
}
