import { CrownGusts, type CrownInstances } from "../wind/crown";
import type { Moment } from "../wind/transition";
import type { ModalTensors } from "./modalTensors";

/** The turbulence that is being sampled, and the gusts at the places of one tree: the same for all forests, as one samples at a time. */
const CROWN_GUSTS = new CrownGusts();
let relative = new Float64Array(0);

/**
 * Gusts at the places of the crowns of one table's trees, which drive the modal model beside the pressure. Nothing is
 * allocated per frame.
 */
export class PlaceGusts {
  /** [count] share of its gusts that each tree feels, 0..1. */
  readonly share: Float32Array;
  private readonly place: Float32Array;
  private readonly exponent: number;
  private moment: Moment | null = null;

  constructor({ place, streamlinedExponent }: ModalTensors, count: number) {
    this.share = new Float32Array(count).fill(1);
    this.place = place;
    this.exponent = streamlinedExponent;
    if (relative.length < place.length) relative = new Float64Array(place.length);
  }

  /** Takes the gusts of a moment. */
  set(moment: Moment): void {
    this.moment = moment;
  }

  /**
   * Writes what the pressures at the G places of tree i are in addition to that at the tree (px, pz), Pa, all in the
   * frame of the tree: along x at all places, then along z. Returns whether there are gusts; otherwise `out` is unchanged.
   */
  write(trees: CrownInstances, i: number, px: number, pz: number, out: Float64Array | Float32Array): boolean {
    const { place, moment } = this;
    const strength = Math.sqrt(px * px + pz * pz);
    const places = place.length / 3;
    if (places === 0 || this.share[i] === 0 || strength === 0 || !moment) return false;
    CROWN_GUSTS.set(moment);
    if (!CROWN_GUSTS.blows) return false;
    CROWN_GUSTS.write(place, this.exponent, trees, i, strength, relative);
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
