/** A tree with its motion. Addresses are absolute, of files of this package or of what a bundler made of them. */
export interface BuiltinTree {
  readonly id: TreeId;
  readonly name: string;
  readonly species: TreeSpecies;
  /** Grown in the open, with a low and wide crown, or among others, with a slender stem and a high crown. */
  readonly form: "open" | "forest";
  readonly height_m: number;
  /** The table of the tree in leaf. */
  readonly tableUrl: string;
  /** The table of the tree without its leaves, which moves the wood and the twigs of the same mesh; evergreens have none. */
  readonly bareTableUrl: string | null;
  /** The GLB that the tables move, with its pictures; compressed with meshopt (EXT_meshopt_compression). */
  readonly meshUrl: string;
  /** Who made it, and under which licence. */
  readonly credits: string;
}

export type TreeSpecies =
  | ("poplar" | "maple" | "apricot" | "birch" | "oak" | "beech")
  | ("ash" | "sycamore" | "willow" | "spruce" | "pine" | "larch");

export type TreeId = TreeSpecies | `${TreeSpecies}-forest`;

declare const tree: BuiltinTree;
export default tree;
