// Tensors of the modal reduced-order model and their numbers of rows.
import { FEWEST_DRAG_INPUTS } from "../constants";

/** d dynamic coordinates (oscillators), c of them coupled, r displayed modes, m drag points, G places of the crown. */
export interface ModalTensors {
  /** [d, 6] r00 − 1, r01, r10, r11 − 1, s0, s1 of each oscillator */
  readonly step: Float32Array;
  /** [d, 2] modal force per Pa along x and z */
  readonly load: Float32Array;
  /** [2, d] the two sway coordinates, 1 at the edge of the sampled range */
  readonly sway: Float32Array;
  /** [44 + 6c, d] */
  readonly force: Float32Array;
  /** [d] m of q_k per unit of coordinate k */
  readonly shown: Float32Array;
  /** [d + 9 + 2c, r − d] m of the remaining q per unit */
  readonly pose: Float32Array;
  /** [3 + 2c] sampled range: sway, its speed 1/s, pressure Pa, coupled coordinates, their speeds */
  readonly limits: Float32Array;
  /** [m, 2] of each drag point: area, m², and share of the wind's pressure in shelter */
  readonly dragPoint: Float32Array;
  /** [3, m, d] velocity x, y, z of each point per unit of the oscillators' speeds */
  readonly dragShape: Float32Array;
  /** [d] area of the motion within the points */
  readonly dragRest: Float32Array;
  /** [m, G] gust at each drag point per unit of those at the places */
  readonly dragPlace: Float32Array;
  /** [G, 3] places whose gusts drive the model, m, tree frame */
  readonly place: Float32Array;
  /** [d, 2, G] modal force per Pa along x and z of the gust at each place */
  readonly placeLoad: Float32Array;
  /** Power of the wind speed with which the pressure grows above 5 m/s */
  readonly streamlinedExponent: number;
}

/** Number of oscillators whose speed determines the velocity of the drag points: the first half, but not too few. */
export function dragInputs(oscillators: number): number {
  return Math.min(oscillators, Math.max(FEWEST_DRAG_INPUTS, Math.floor(oscillators / 2)));
}

/** [G] weights of the places in the mean gust over the crown: that of the drag points by sheltered area. */
export function meanGust({ dragPoint, dragPlace, place }: ModalTensors): Float64Array {
  const mean = new Float64Array(place.length / 3);
  let whole = 0;
  for (let j = 0; 2 * j < dragPoint.length; j++) {
    const sheltered = dragPoint[2 * j] * dragPoint[2 * j + 1];
    whole += sheltered;
    for (let g = 0; g < mean.length; g++) mean[g] += sheltered * dragPlace[j * mean.length + g];
  }
  return whole > 0 ? mean.map((sum) => sum / whole) : mean;
}

/** Number of coupled coordinates, from the length of `limits`. */
export function coupledOf(limits: number): number {
  return (limits - 3) / 2;
}

/** Rows of the force: terms in the pose, with the sway velocity, with the pressure, and of the coupled coordinates. */
export function forceTerms(coupled: number): number {
  return 44 + 6 * coupled;
}

/** Rows of the pose map: the coordinates, the pressure, and the terms in the pose. */
export function poseTerms(dynamic: number, coupled: number): number {
  return dynamic + 9 + 2 * coupled;
}

/** Whether every oscillator's step is a contraction, so that bounded wind gives bounded motion. */
export function contracts(step: Float32Array): boolean {
  for (let k = 0; k < step.length; k += 6) {
    const r00 = 1 + step[k];
    const r11 = 1 + step[k + 3];
    const product = r00 * r11 - step[k + 1] * step[k + 2];
    if (!(Math.abs(product) < 1 && Math.abs(r00 + r11) < 1 + product)) return false;
  }
  return true;
}
