import type { Foliage } from "./growth/foliage";
import type { Habit } from "./growth/growth";
import type { Girth } from "./growth/skeleton";
import type { Twigs } from "./growth/twigs";
import type { WoodCut } from "./growth/wood";
import type { Bark } from "./pictures/bark-picture";
import type { LeafLook } from "./pictures/leaf-look";

/** Parameters of one form of a species. */
export interface Species {
  id: string;
  name: string;
  /** Key of its wood in the Python table of species. */
  wood: string;
  /** Grown in the open, or in a closed forest: slender with a high crown. */
  form: "open" | "forest";
  /** Height of the whole tree in leaf, m. */
  height_m: number;
  habit: Habit;
  girth: Girth;
  cut: WoodCut;
  twigs: Twigs;
  foliage: Foliage;
  leaf: LeafLook;
  bark: Bark;
  /** Strength of the bark relief in the normal map. */
  barkRelief: number;
}
