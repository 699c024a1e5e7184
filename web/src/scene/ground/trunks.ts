/** Where trees stand, for plants that must keep clear of them or grow below their crowns. Pure. */
import { CROWN_FLOATS, type Crowns } from "../sky/exposure";

const CELL_M = 8;
const key = (column: number, row: number) => column * 65_536 + row;

export class Trunks {
  private readonly cells = new Map<number, number[]>();

  constructor(private readonly crowns: Crowns) {
    for (let at = 0; at < crowns.length; at += CROWN_FLOATS) {
      const cell = key(Math.floor(crowns[at] / CELL_M), Math.floor(crowns[at + 2] / CELL_M));
      const list = this.cells.get(cell);
      if (list) list.push(at);
      else this.cells.set(cell, [at]);
    }
  }

  /** The nearest trunk within 8 m: its distance (m, infinite without one), and the place of its crown in the array. */
  nearest(x: number, z: number): { away_m: number; crown: number } {
    const [column, row] = [Math.floor(x / CELL_M), Math.floor(z / CELL_M)];
    let [away_m, crown] = [Number.POSITIVE_INFINITY, -1];
    for (let c = column - 1; c <= column + 1; c++) {
      for (let r = row - 1; r <= row + 1; r++) {
        for (const at of this.cells.get(key(c, r)) ?? []) {
          const d = Math.hypot(this.crowns[at] - x, this.crowns[at + 2] - z);
          if (d < away_m) [away_m, crown] = [d, at];
        }
      }
    }
    return { away_m, crown };
  }

  /** Half width of a crown, m, the colour of its leaves, and whether they fall. */
  crownOf(crown: number): { wide_m: number; colour: readonly [number, number, number]; sheds: boolean } {
    const [wide_m, , r, g, b, falling] = this.crowns.subarray(crown + 3, crown + CROWN_FLOATS);
    return { wide_m, colour: [r, g, b], sheds: falling > 0 };
  }
}
