import { ISOTROPIC_DRAG } from "../constants";
import { pressurePerSpeed, speedOfPressure_m_s } from "../wind/pressure";
import { dragInputs, type ModalTensors } from "./modalTensors";

/**
 * Drag at a few points of the crown, from the velocity of the sheltered air relative to them.
 * precompute/galewood/motion/modal/drag.py explains it.
 */
export class ModalDrag {
  private readonly point: Float64Array;
  private readonly shape: Float64Array;
  private readonly rest: Float64Array;
  private readonly d: number;
  private readonly m: number;
  private readonly inputs: number;
  private readonly whole: number;
  private readonly exponent: number;

  constructor({ dragPoint, dragShape, dragRest, streamlinedExponent }: ModalTensors) {
    this.point = Float64Array.from(dragPoint);
    this.shape = Float64Array.from(dragShape);
    this.rest = Float64Array.from(dragRest);
    this.d = dragRest.length;
    this.m = dragPoint.length / 2;
    this.inputs = dragInputs(this.d);
    this.exponent = streamlinedExponent;
    let whole = 0;
    for (let j = 0; j < this.m; j++) whole += this.point[2 * j];
    this.whole = whole;
  }

  /** Adds the drag at the speeds `v` [d] in a wind of pressure (px, pz), Pa, to the forces `total` [d]. */
  add(v: Float64Array, px: number, pz: number, total: Float64Array): void {
    const { d, m, point, rest, whole, exponent } = this;
    const wind_pa = Math.sqrt(px * px + pz * pz);
    let mean = 0;
    for (let j = 0; j < m; j++) {
      const area = point[2 * j];
      const share = point[2 * j + 1];
      const air = wind_pa > 0 ? speedOfPressure_m_s(share * wind_pa, exponent) / wind_pa : 0;
      const x = air * px - this.speed(v, j);
      const y = -this.speed(v, m + j);
      const z = air * pz - this.speed(v, 2 * m + j);
      const perSpeed = pressurePerSpeed(Math.sqrt(x * x + y * y + z * z), exponent);
      mean += (area * perSpeed) / whole;
      this.push(area * (perSpeed * x - share * px), j, total);
      this.push(area * perSpeed * y, m + j, total);
      this.push(area * (perSpeed * z - share * pz), 2 * m + j, total);
    }
    for (let k = 0; k < d; k++) total[k] -= ISOTROPIC_DRAG * rest[k] * mean * v[k];
  }

  private speed(v: Float64Array, row: number): number {
    let speed = 0;
    for (let k = 0, at = row * this.d; k < this.inputs; k++, at++) speed += this.shape[at] * v[k];
    return speed;
  }

  private push(force: number, row: number, total: Float64Array): void {
    for (let k = 0, at = row * this.d; k < this.d; k++, at++) total[k] += force * this.shape[at];
  }
}
