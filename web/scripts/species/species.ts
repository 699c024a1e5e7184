import type { Bark } from "./bark-picture";
import type { Foliage } from "./foliage";
import type { Habit } from "./growth";
import type { LeafLook } from "./leaf-look";
import type { Girth } from "./skeleton";
import type { WoodCut } from "./wood";

/** Parameters of one species. */
export interface Species {
  id: string;
  name: string;
  /** Key of its wood in the Python table of species. */
  wood: string;
  /** Height of the wood, m; leaves extend slightly above it. */
  height_m: number;
  habit: Habit;
  girth: Girth;
  cut: WoodCut;
  foliage: Foliage;
  leaf: LeafLook;
  bark: Bark;
  /** Strength of the bark relief in the normal map. */
  barkRelief: number;
}
