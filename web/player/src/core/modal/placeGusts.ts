import { CrownGusts, type CrownInstances } from "../wind/crown";
import type { Moment } from "../wind/transition";
import type { ModalTensors } from "./modalTensors";

/**
 * Gusts at the places of the crowns of one table's trees, which drive the modal model beside the pressure. Nothing is
 * allocated per frame.
 */
export class PlaceGusts {
  /** [count] share of its gusts that each tree feels, 0..1. */
  readonly share: Float32Array;
  private readonly place: Float64Array;
  private readonly relative: Float64Array;
  private readonly field: CrownGusts;

  constructor({ place, streamlinedExponent }: ModalTensors, count: number) {
    this.share = new Float32Array(count).fill(1);
    this.place = Float64Array.from(place);
    this.relative = new Float64Array((2 * place.length) / 3);
    this.field = new CrownGusts(streamlinedExponent);
  }

  /** Takes the gusts of a moment. */
  set(moment: Moment): void {
    this.field.set(moment);
  }

  /**
   * Writes what the pressures at the G places of tree i are in addition to that at the tree (px, pz), Pa, all in the
   * frame of the tree: along x at all places, then along z. Returns whether there are gusts; otherwise `out` is unchanged.
   */
  write(trees: CrownInstances, i: number, px: number, pz: number, out: Float64Array | Float32Array): boolean {
    const { relative, field } = this;
    const strength = Math.sqrt(px * px + pz * pz);
    const places = relative.length / 2;
    if (places === 0 || this.share[i] === 0 || strength === 0 || !field.blows) return false;
    field.write(this.place, trees, i, strength, relative);
    const x = px * this.share[i];
    const z = pz * this.share[i];
    for (let g = 0; g < places; g++) {
      const along = relative[2 * g];
      const across = relative[2 * g + 1];
      out[g] = along * x - across * z;
      out[places + g] = along * z + across * x;
    }
    return true;
  }
}
