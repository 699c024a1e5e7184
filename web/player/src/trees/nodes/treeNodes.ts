/** What draws pass 1 of a species, and where the texels of its trees are. */
import type { RenderTarget } from "three";
import type { Easing } from "../../core/motion/easedPoses";
import type { DrawList } from "../drawList";
import type { NodeRenderer } from "./nodeGraphics";

/** Location of the level's trees in the target of pass 1. */
export interface LevelTexels {
  readonly first: number;
  readonly trees: number;
  readonly nodes: number;
}

/** Nodes of all drawn trees of a species. */
export interface TreeNodes {
  /** The finished texels. */
  readonly target: RenderTarget;
  /** log2 of the target's width, as a uniform. */
  readonly shift: { value: number };
  /** Assigns texels to every tree of the list; `told` is given those of each level, and again when they move. */
  place(list: DrawList, told: (texels: readonly LevelTexels[]) => void): void;
  /** Sets the newest poses: `stride` floats per tree, as written by the worker. */
  setPoses(poses: Float32Array, easing: Easing | null): void;
  render(renderer: NodeRenderer): void;
  dispose(): void;
}
