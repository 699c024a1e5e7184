/** Plants on a square lattice that wraps around the camera, so that each stays in place while the camera moves. Pure. */

/** Writes the plant of a cell into a slot. */
export type Grow = (slot: number, column: number, row: number) => void;

/** Cells are filled when the camera has moved about this far, so that fine lattices are not uploaded all the time. */
const STRIDE_M = 1.3;

/** Cells that one update fills: more would be felt as a pause. */
const CELLS_AT_ONCE = 4000;

export class Lattice {
  private readonly stride: number;
  private column = Number.NaN;
  private row = Number.NaN;
  private before = { column: Number.NaN, row: Number.NaN };
  /** The next row to fill; `side` when all are. */
  private pending: number;

  /** `side`: cells along each axis; even. */
  constructor(
    readonly side: number,
    readonly spacing_m: number,
    private readonly grow: Grow,
  ) {
    this.pending = side;
    this.stride = Math.max(1, Math.round(STRIDE_M / spacing_m));
  }

  get slots(): number {
    return this.side * this.side;
  }

  /** Distance from the camera at which plants end. */
  get reach_m(): number {
    return 0.5 * (this.side - this.stride) * this.spacing_m;
  }

  /** Grows all plants anew from the next update on. */
  reset(): void {
    this.column = Number.NaN;
    this.pending = this.side;
  }

  /**
   * Fills the cells that came into range, some rows at each call; all others keep their plants. Returns whether the
   * plants around the camera are complete and have changed.
   */
  update(eye: { x: number; z: number }): boolean {
    const { side, stride } = this;
    if (this.pending >= side) {
      const column = stride * Math.round(eye.x / (this.spacing_m * stride));
      const row = stride * Math.round(eye.z / (this.spacing_m * stride));
      if (column === this.column && row === this.row) return false;
      this.before = { column: this.column, row: this.row };
      this.column = column;
      this.row = row;
      this.pending = 0;
    }
    for (let cells = 0; cells < CELLS_AT_ONCE && this.pending < side; this.pending++) cells += this.fillRow();
    return this.pending >= side;
  }

  /** Fills the next row; returns the number of its new cells. */
  private fillRow(): number {
    const { side, before, column } = this;
    const half = side >> 1;
    const r = this.row - half + this.pending;
    const known = !Number.isNaN(before.column) && r >= before.row - half && r < before.row + half;
    let cells = 0;
    for (let c = column - half; c < column + half; c++) {
      if (known && c >= before.column - half && c < before.column + half) continue;
      this.grow((((r % side) + side) % side) * side + (((c % side) + side) % side), c, r);
      cells++;
    }
    return cells;
  }
}
