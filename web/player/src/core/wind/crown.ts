/**
 * Turbulence within a crown: gusts of a few metres, which the gust models of a forest are too coarse for. A frozen,
 * periodic velocity field carried over the forest by the wind. Specified in spec/formats/wind.md; sources in
 * precompute/galewood/motion/wind/crown.py.
 */
import {
  CROWN_CELL_M,
  CROWN_CELLS,
  CROWN_FEWEST_PERIODS,
  CROWN_INTENSITY,
  CROWN_LEAN_ACROSS,
  CROWN_LEAN_ALONG,
  CROWN_MOST_GUST,
  CROWN_MOST_PERIODS,
  CROWN_SLANT,
  CROWN_WAVES,
  HASH_TURN_RAD,
  STREAMLINING_PRESSURE_PA,
} from "../constants";
import type { Places } from "./frame";
import { hash32 } from "./hashing";
import type { Moment } from "./transition";

/** The fields of the last winds by their seeds: 65 kB each, which all tables of a forest share. */
const FIELDS = new Map<number, Float64Array>();
const KEPT_FIELDS = 4;

/** Velocity along and across the wind at the grid points, [cells, cells, 2], unit variance each. */
function crownField(seed: number): Float64Array {
  const known = FIELDS.get(seed);
  if (known) return known;
  if (FIELDS.size >= KEPT_FIELDS) FIELDS.clear();
  const field = madeField(seed);
  FIELDS.set(seed, field);
  return field;
}

function madeField(seed: number): Float64Array<ArrayBuffer> {
  const field = new Float64Array(CROWN_CELLS * CROWN_CELLS * 2);
  for (let k = 0; k < CROWN_WAVES; k++) addWave(field, seed, k);
  for (let side = 0; side < 2; side++) {
    let square = 0;
    for (let i = side; i < field.length; i += 2) square += field[i] * field[i];
    const size = Math.sqrt(square / (CROWN_CELLS * CROWN_CELLS));
    for (let i = side; i < field.length; i += 2) field[i] /= size;
  }
  return field;
}

/** Adds a plane wave across its own direction, so that the field is free of divergence. */
function addWave(field: Float64Array, seed: number, k: number): void {
  const number =
    CROWN_FEWEST_PERIODS * (CROWN_MOST_PERIODS / CROWN_FEWEST_PERIODS) ** ((k + 0.5) / CROWN_WAVES);
  const heading = hash32(seed, 3 * k) * HASH_TURN_RAD;
  const m = Math.floor(number * Math.cos(heading) + 0.5);
  const n = Math.floor(number * Math.sin(heading) + 0.5);
  const size = Math.hypot(m, n);
  const start = hash32(seed, 3 * k + 1) * HASH_TURN_RAD;
  const strength = size ** (-1 / 3);
  const phase = (2 * Math.PI) / CROWN_CELLS;
  for (let row = 0, at = 0; row < CROWN_CELLS; row++) {
    for (let column = 0; column < CROWN_CELLS; column++, at += 2) {
      const wave = strength * Math.cos(n * (row * phase) + m * (column * phase) + start);
      field[at] += (wave * -n) / size;
      field[at + 1] += (wave * m) / size;
    }
  }
}

/** Instances of one tree, as the crown turbulence needs them. */
export interface CrownInstances {
  readonly x: Places;
  readonly z: Places;
  /** [count, 3] cosine and sine of the yaw, scale. */
  readonly turn: Places;
}

/** The crown turbulence of a wind at one moment. */
export class CrownGusts {
  private field: Float64Array = new Float64Array(0);
  private readonly frame = new Float64Array(8);
  private moment: Moment | null = null;
  private cos = 1;
  private sin = 0;
  private distance_m = 0;
  private intensity = 0;

  set(moment: Moment): void {
    if (moment === this.moment) return;
    this.moment = moment;
    const { wind, travel, crown } = moment;
    const heading = (wind.direction_deg * Math.PI) / 180;
    this.cos = Math.cos(heading);
    this.sin = Math.sin(heading);
    this.distance_m = travel * crown.length_scale_m;
    this.intensity = CROWN_INTENSITY * wind.gustiness * crown.weight;
    this.field = crownField(crown.seed);
  }

  /** Whether there are gusts at all. */
  get blows(): boolean {
    return this.intensity > 0;
  }

  /**
   * Writes the relative gusts at the places [G, 3] of tree i in a wind of this pressure (Pa): what the pressure there is
   * in addition to that at the tree, along it and across it, over its strength. `exponent`: that of the trees (`dynamicPressure`).
   */
  write(
    places: Places,
    exponent: number,
    trees: CrownInstances,
    i: number,
    pressure_pa: number,
    out: Float64Array,
  ): void {
    const { field, intensity } = this;
    if (intensity === 0 || pressure_pa === 0) {
      out.fill(0);
      return;
    }
    const growth = pressure_pa > STREAMLINING_PRESSURE_PA ? exponent : 2;
    const frame = this.frameOf(trees, i);
    for (let at = 0, to = 0; at < places.length; at += 3, to += 2) {
      const x = places[at];
      const y = places[at + 1];
      const z = places[at + 2];
      const along = frame[0] + frame[1] * x + frame[2] * y + frame[3] * z;
      const across = frame[4] + frame[5] * x + frame[6] * y + frame[7] * z + CROWN_SLANT * along;
      const column = Math.floor(along);
      const row = Math.floor(across);
      const t = along - column;
      const w = across - row;
      const left = 2 * (column & (CROWN_CELLS - 1));
      const right = 2 * ((column + 1) & (CROWN_CELLS - 1));
      const near = 2 * CROWN_CELLS * (row & (CROWN_CELLS - 1));
      const far = 2 * CROWN_CELLS * ((row + 1) & (CROWN_CELLS - 1));
      const nearLeft = (1 - t) * (1 - w);
      const nearRight = t * (1 - w);
      const farLeft = (1 - t) * w;
      const farRight = t * w;
      out[to] =
        growth *
        held(
          intensity *
            (nearLeft * field[near + left] +
              nearRight * field[near + right] +
              farLeft * field[far + left] +
              farRight * field[far + right]),
        );
      out[to + 1] = held(
        intensity *
          (nearLeft * field[near + left + 1] +
            nearRight * field[near + right + 1] +
            farLeft * field[far + left + 1] +
            farRight * field[far + right + 1]),
      );
    }
  }

  /**
   * Of tree i: the cell along the wind of its origin and per metre along its x, y and z, then the same across the wind
   * without the slant.
   */
  private frameOf({ x, z, turn }: CrownInstances, i: number): Float64Array {
    const { cos, sin, frame } = this;
    const scale = turn[3 * i + 2] / CROWN_CELL_M;
    // three.js rotation.y: x of the tree is (c, -s) in the world, z is (s, c).
    const c = turn[3 * i];
    const s = turn[3 * i + 1];
    frame[0] = (cos * x[i] + sin * z[i] - this.distance_m) / CROWN_CELL_M;
    frame[1] = scale * (cos * c - sin * s);
    frame[2] = scale * CROWN_LEAN_ALONG;
    frame[3] = scale * (cos * s + sin * c);
    frame[4] = (cos * z[i] - sin * x[i]) / CROWN_CELL_M;
    frame[5] = scale * (-cos * s - sin * c);
    frame[6] = scale * CROWN_LEAN_ACROSS;
    frame[7] = scale * (cos * c - sin * s);
    return frame;
  }
}

/** A gust within its limits. */
function held(gust: number): number {
  return Math.min(Math.max(gust, -CROWN_MOST_GUST), CROWN_MOST_GUST);
}
