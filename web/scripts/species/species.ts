import type { Bark } from "./bark-picture";
import type { Foliage } from "./foliage";
import type { Habit } from "./growth";
import type { LeafLook } from "./leaf-look";
import type { Girth } from "./skeleton";
import type { WoodCut } from "./wood";

/** All that is needed to grow one species. */
export interface Species {
  id: string;
  name: string;
  /** Key of its wood in the precompute's table of species. */
  wood: string;
  /** Height of the topmost wood, m; leaves stand a little above it. */
  height_m: number;
  habit: Habit;
  girth: Girth;
  cut: WoodCut;
  foliage: Foliage;
  leaf: LeafLook;
  bark: Bark;
  /** Strength of the bark's relief in its normal picture. */
  barkRelief: number;
}
