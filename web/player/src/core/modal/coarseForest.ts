/** Trees of one table that can also be stepped by coarse models, while they are far away. */
import { FAR_COORDINATES, leadingCoordinates } from "../table/leadingCoordinates";
import type { Table } from "../table/table";
import { coarseModel } from "./coarseModel";
import { ModalForest } from "./modalForest";
import type { PlaceGusts } from "./placeGusts";

/** Oscillators of the coarse models. */
const COARSE_OSCILLATORS = 8;

export class CoarseForest extends ModalForest {
  /** The coordinates that are displayed of distant trees. */
  readonly coordinates: Uint16Array;
  /** Where these are in a row of `now`. */
  private readonly places: Uint16Array;
  /** Which model `step` steps: 0 is the table's own. */
  private model = 0;

  /** `steps`: table steps in one of each coarse model. */
  constructor(
    table: Table,
    count: number,
    private readonly stepsOf: readonly number[],
  ) {
    const { modal, metadata } = table;
    const { modes, dt_s } = metadata;
    super(
      table,
      count,
      false,
      stepsOf.map((steps) => coarseModel(modal, modes, dt_s, COARSE_OSCILLATORS, steps)),
    );
    const { own, d } = this;
    this.coordinates = leadingCoordinates(modes, d, FAR_COORDINATES);
    this.places = this.coordinates.map((k) => (k < d ? k : own + k - d));
  }

  /** Advances the listed trees as `advance` does all. */
  advanceSome(
    dtS: number,
    pressureX: Float32Array,
    pressureZ: Float32Array,
    trees: Uint32Array,
    gusts: PlaceGusts | null,
  ): void {
    this.gusts = gusts;
    for (let k = 0; k < trees.length; k++)
      this.advanceOne(trees[k], dtS, pressureX[trees[k]], pressureZ[trees[k]]);
    this.gusts = null;
  }

  /**
   * Advances tree i by dt seconds under a world pressure (Pa) with coarse model `model`, without gusts within the crown, and
   * writes its displayed coordinates to their places in a pose that begins at `to`; the others stay as they are.
   */
  advanceFar(
    i: number,
    dtS: number,
    model: number,
    pressureX: number,
    pressureZ: number,
    out: Float32Array,
    to: number,
  ): void {
    this.rotatePressure(i, pressureX, pressureZ);
    this.model = model + 1;
    const part = this.advanceBy(i, dtS, this.stepsOf[model]);
    this.model = 0;
    const { now, before, coordinates, places } = this;
    const from = i * this.width;
    for (let k = 0; k < coordinates.length; k++) {
      const at = from + places[k];
      out[to + coordinates[k]] = before[at] + (now[at] - before[at]) * part;
    }
  }

  /** Prepares a tree for the coarse models: what they leave out stops where it is displayed. */
  leaveOut(i: number): void {
    const { now, before, own, d, r, width } = this;
    const first = i * width;
    for (let k = COARSE_OSCILLATORS; k < d; k++) {
      this.v[first + k] = 0;
      before[first + k] = now[first + k];
    }
    for (let k = own + 1; k < own + r - d; k++) before[first + k] = now[first + k];
  }

  protected override step(i: number, px: number, pz: number): void {
    if (this.model === 0) super.step(i, px, pz);
    else this.stepBy(this.model, i, px, pz, 0);
  }
}
