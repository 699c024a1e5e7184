/**
 * A drag constraint: a limited force that pulls a point of a tree towards a target. Forces and places in the
 * tree's frame, at scale 1.
 */
import { PULL_LAG_S, PULL_STRETCH_SHARE } from "../constants";
import type { PointResponse } from "./pointResponse";

export type Vector = readonly [number, number, number];

export class DragConstraint {
  readonly force_N = new Float64Array(3);
  /** How fast the force changes, smoothed. */
  private readonly rate_N_s = new Float64Array(3);
  private readonly forceOf: Float64Array;
  private readonly goal = new Float64Array(3);

  constructor(readonly response: PointResponse) {
    const c = response.compliance;
    const soft = (PULL_STRETCH_SHARE * (c[0] + c[4] + c[8])) / 3;
    // damped least squares: stiff directions, along a branch, would need enormous forces
    const square = product(c, c);
    for (let k = 0; k < 9; k += 4) square[k] += soft * soft + 1e-30;
    this.forceOf = product(inverse(square), c);
  }

  /** Follows a target, the displacement of the point from rest; the wind has moved it by `swayed`. */
  step(dt_s: number, target_m: Vector, swayed_m: ArrayLike<number>): void {
    if (!(dt_s > 0)) return;
    const { goal, force_N, rate_N_s, forceOf, response } = this;
    const wanted = Float64Array.from(target_m, (value, axis) => value - swayed_m[axis]);
    limit(wanted, response.reach_m);
    for (let i = 0; i < 3; i++)
      goal[i] = forceOf[3 * i] * wanted[0] + forceOf[3 * i + 1] * wanted[1] + forceOf[3 * i + 2] * wanted[2];
    limit(goal, response.limit_N);
    const share = dt_s / (PULL_LAG_S + dt_s);
    for (let i = 0; i < 3; i++) {
      const change = share * (goal[i] - force_N[i]);
      force_N[i] += change;
      rate_N_s[i] += share * (change / dt_s - rate_N_s[i]);
    }
  }

  /** Adds what the modes show to a row of poses. */
  addPose(out: Float32Array, first: number): void {
    addProduct(this.response.pose, this.force_N, out, first);
  }

  /** What a release adds to the oscillators' coordinates and to their speeds. */
  get released(): { e: Float64Array; v: Float64Array } {
    const { oscillators } = this.response;
    const d = oscillators.length / 3;
    const e = new Float64Array(d);
    const v = new Float64Array(d);
    addProduct(oscillators, this.force_N, e, 0);
    addProduct(oscillators, this.rate_N_s, v, 0);
    return { e, v };
  }
}

/** out[first …] += rows [k, 3] × vector [3]. */
function addProduct(
  rows: Float64Array,
  vector: ArrayLike<number>,
  out: Float32Array | Float64Array,
  first: number,
): void {
  for (let k = 0; k < rows.length / 3; k++) {
    out[first + k] += rows[3 * k] * vector[0] + rows[3 * k + 1] * vector[1] + rows[3 * k + 2] * vector[2];
  }
}

/** Shortens a vector to this length. */
function limit(vector: Float64Array, most: number): void {
  const length = Math.hypot(vector[0], vector[1], vector[2]);
  if (length > most) for (let k = 0; k < 3; k++) vector[k] *= most / length;
}

function product(a: Float64Array, b: Float64Array): Float64Array {
  return Float64Array.from({ length: 9 }, (_, at) => {
    const [i, j] = [3 * Math.floor(at / 3), at % 3];
    return a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j];
  });
}

function inverse([a, b, c, d, e, f, g, h, i]: Float64Array): Float64Array {
  const cofactors = [e * i - f * h, c * h - b * i, b * f - c * e];
  cofactors.push(f * g - d * i, a * i - c * g, c * d - a * f);
  cofactors.push(d * h - e * g, b * g - a * h, a * e - b * d);
  const determinant = a * cofactors[0] + b * cofactors[3] + c * cofactors[6];
  return Float64Array.from(cofactors, (value) => value / determinant);
}
