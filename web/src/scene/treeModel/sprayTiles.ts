/** The pictures of leaf cards, and of the sprays of a species, which the generator of the built-in trees draws and `leafSprays.ts` cuts into tiles. */

/** Square tiles, each with another spray, its foot in the middle of the lower edge. */
export const SPRAY_TILES = { columns: 4, rows: 2 } as const;
/** Below them is a row of tiles with a single leaf each, upright, the foot of its petiole in the middle of the lower edge. */
export const SHEET_ROWS = SPRAY_TILES.rows + 1;
/** Side of a tile relative to that of the leaf card of which its spray is a part. */
export const SPRAY_SHARE = 0.6;

/** The picture of the leaf cards of a built-in tree has as many tiles along each side, each with another shoot. */
export const SHOOT_TILES_PER_SIDE = 2;

/**
 * A leaf in the picture of a spray: the foot of its petiole (x, y) relative to the side of the tile, from the lower left corner; its angle
 * to the vertical, rad, clockwise; the side of the square, relative to that tile, which the tile of a single leaf fills; and how
 * narrow it is drawn, because it is turned away.
 */
export type DrawnLeaf = readonly [x: number, y: number, angle_rad: number, side: number, squeeze: number];

/** What the picture of the sprays of a species shows; of needles nothing is told. */
export interface DrawnSprays {
  /** Half the width of a single leaf, and the length of its petiole, relative to its tile. */
  readonly half: number;
  readonly petiole: number;
  /** Length of a petiole, m. */
  readonly petiole_m: number;
  /** Of each spray: points along its shoot, relative to the side of the tile, and its leaves. */
  readonly tiles: readonly {
    readonly shoot: readonly (readonly [number, number])[];
    readonly leaves: readonly DrawnLeaf[];
  }[];
}
