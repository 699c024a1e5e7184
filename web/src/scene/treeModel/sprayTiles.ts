/** The pictures of leaf cards, and of the sprays of a species, which the generator of the built-in trees draws and `leafSprays.ts` cuts into tiles. */

/** Square tiles, each with another spray, its foot in the middle of the lower edge. */
export const SPRAY_TILES = { columns: 4, rows: 2 } as const;
/** Side of a tile relative to that of the leaf card of which its spray is a part. */
export const SPRAY_SHARE = 0.6;

/** The picture of the leaf cards of a built-in tree has as many tiles along each side, each with another shoot. */
export const SHOOT_TILES_PER_SIDE = 2;
