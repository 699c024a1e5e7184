/** Instances of one kind of plant around the camera; only cells in which one grows are drawn. */
import {
  type BufferGeometry,
  DynamicDrawUsage,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
} from "three";
import { Lattice } from "./lattice";

/** Floats per plant: aPlant (x, y, z, size in m; 0 for none) and aLook (free for the kind). */
const PLANT_FLOATS = 8;
/** Writes the plant of a cell. */
export type WritePlant = (out: Float32Array, at: number, column: number, row: number) => void;

export class PlantField {
  readonly geometry = new InstancedBufferGeometry();
  private readonly lattice: Lattice;
  /** One plant per cell. */
  private readonly cells: Float32Array;
  private readonly shown: InstancedInterleavedBuffer;

  /** `side`: cells along each axis; even. */
  constructor(plant: BufferGeometry, side: number, spacing_m: number, write: WritePlant) {
    this.lattice = new Lattice(side, spacing_m, (slot, column, row) =>
      write(this.cells, slot * PLANT_FLOATS, column, row),
    );
    this.cells = new Float32Array(PLANT_FLOATS * this.lattice.slots);
    this.shown = new InstancedInterleavedBuffer(new Float32Array(this.cells.length), PLANT_FLOATS);
    this.shown.setUsage(DynamicDrawUsage);
    this.geometry.setIndex(plant.index);
    for (const name of Object.keys(plant.attributes))
      this.geometry.setAttribute(name, plant.getAttribute(name));
    this.geometry.setAttribute("aPlant", new InterleavedBufferAttribute(this.shown, 4, 0));
    this.geometry.setAttribute("aLook", new InterleavedBufferAttribute(this.shown, 4, 4));
    this.geometry.instanceCount = 0;
  }

  get reach_m(): number {
    return this.lattice.reach_m;
  }

  /** Grows all plants anew at the next update. */
  reset(): void {
    this.lattice.reset();
  }

  update(eye: { x: number; z: number }): void {
    if (!this.lattice.update(eye)) return;
    const to = this.shown.array as Float32Array;
    let count = 0;
    for (let at = 0; at < this.cells.length; at += PLANT_FLOATS) {
      if (this.cells[at + 3] === 0) continue;
      for (let k = 0; k < PLANT_FLOATS; k++) to[count * PLANT_FLOATS + k] = this.cells[at + k];
      count++;
    }
    this.geometry.instanceCount = count;
    this.shown.clearUpdateRanges();
    this.shown.addUpdateRange(0, count * PLANT_FLOATS);
    this.shown.needsUpdate = count > 0;
  }
}
