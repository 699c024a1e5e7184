/** A tree with its motion. Addresses are absolute, of files of this package or of what a bundler made of them. */
export interface BuiltinTree {
  readonly id: TreeId;
  readonly name: string;
  readonly species: "poplar" | "maple" | "apricot";
  /** Grown in the open, with a low and wide crown, or among others, with a slender stem and a high crown. */
  readonly form: "open" | "forest";
  readonly height_m: number;
  /** The table of the tree in leaf. */
  readonly tableUrl: string;
  /** The table of the tree without its leaves; it moves the wood and the twigs of the same mesh. */
  readonly bareTableUrl: string;
  /** The GLB that the tables move, with its pictures; compressed with meshopt (EXT_meshopt_compression). */
  readonly meshUrl: string;
  /** Who made it, and under which licence. */
  readonly credits: string;
}

export type TreeId = "poplar" | "maple" | "apricot" | "poplar-forest" | "maple-forest" | "apricot-forest";

declare const tree: BuiltinTree;
export default tree;
