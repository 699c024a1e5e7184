// What the drift-free method's tensors are, and how many rows they have.

/** Tensors of the method: d dynamic coordinates, c coupled ones, r shown modes. */
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
  /** [d + 9 + 2c, r − d] m of the further q per unit */
  readonly pose: Float32Array;
  /** [3 + 2c] sampled range: sway, its speed 1/s, pressure Pa, coupled coordinates, their speeds */
  readonly limits: Float32Array;
}

/** c, of so many numbers of the sampled range. */
export function coupledOf(limits: number): number {
  return (limits - 3) / 2;
}

/** Rows of the force: the terms in the pose, those with the sway's speed and with the pressure, and the coupled. */
export function forceTerms(coupled: number): number {
  return 44 + 6 * coupled;
}

/** Rows of the pose map: the coordinates, the pressure, and the terms in the pose. */
export function poseTerms(dynamic: number, coupled: number): number {
  return dynamic + 9 + 2 * coupled;
}

/** Whether every oscillator's step contracts: then a bounded wind gives a bounded motion. */
export function contracts(step: Float32Array): boolean {
  for (let k = 0; k < step.length; k += 6) {
    const r00 = 1 + step[k];
    const r11 = 1 + step[k + 3];
    const product = r00 * r11 - step[k + 1] * step[k + 2];
    if (!(Math.abs(product) < 1 && Math.abs(r00 + r11) < 1 + product)) return false;
  }
  return true;
}
