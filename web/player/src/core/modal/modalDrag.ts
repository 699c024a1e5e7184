import { ISOTROPIC_DRAG } from "../constants";
import type { Numbers } from "../motion/treeInstances";
import { pressurePerSpeed, speedOfPressure_m_s } from "../wind/pressure";
import { dragInputs, type ModalTensors } from "./modalTensors";

/**
 * Drag at a few points of the crown, from the velocity of the sheltered air relative to them. The wind at each is that at
 * the tree plus the gusts of the places around.
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
  private readonly place: Float64Array;
  /** [2, m] pressure of the wind at each point along x, then along z, Pa. */
  private readonly air: Float64Array;

  constructor({ dragPoint, dragShape, dragRest, dragPlace, streamlinedExponent }: ModalTensors) {
    this.point = Float64Array.from(dragPoint);
    this.shape = Float64Array.from(dragShape);
    this.rest = Float64Array.from(dragRest);
    this.d = dragRest.length;
    this.m = dragPoint.length / 2;
    this.inputs = dragInputs(this.d);
    this.exponent = streamlinedExponent;
    this.place = Float64Array.from(dragPlace);
    this.air = new Float64Array(2 * this.m);
    let whole = 0;
    for (let j = 0; j < this.m; j++) whole += this.point[2 * j];
    this.whole = whole;
  }

  /**
   * Takes the wind: the pressure (px, pz) at the tree, Pa, and the gusts [2, G] at the places; `places`: G, or 0 without
   * gusts.
   */
  setWind(px: number, pz: number, places: number, gusts: Numbers): void {
    const { m, place, air } = this;
    for (let j = 0; j < m; j++) {
      let x = px;
      let z = pz;
      for (let g = 0; g < places; g++) {
        x += place[j * places + g] * gusts[g];
        z += place[j * places + g] * gusts[places + g];
      }
      air[j] = x;
      air[m + j] = z;
    }
  }

  /** Adds the drag at the speeds `v` [d] to the forces `total` [d]. */
  add(v: Float64Array, total: Float64Array): void {
    const { d, m, point, rest, whole, exponent } = this;
    let mean = 0;
    for (let j = 0; j < m; j++) {
      const area = point[2 * j];
      const share = point[2 * j + 1];
      const px = this.air[j];
      const pz = this.air[m + j];
      const wind_pa = Math.sqrt(px * px + pz * pz);
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
