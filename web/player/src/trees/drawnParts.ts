/** The parts of a species as they are drawn, and what draws them at all levels of detail. */
import type { Camera, Group } from "three";
import type { DrawnMotion } from "../core/table/drawnTable";
import type { DrawList } from "./drawList";
import type { TreePart } from "./mesh/treeMesh";
import type { LevelTexels, TreeNodes } from "./nodes/treeNodes";
import type { PartMaterials } from "./partMaterials";
import type { TogetherUniforms } from "./treeShader";

export interface PlannedPart {
  readonly part: TreePart;
  /** Its vertices are bound to those of the table from this one on. */
  readonly firstVertex: number;
  /** The first vertex of the part in the fields of pulled points, or `ADDED_PART`. */
  readonly pullFirst: number;
  /** Whether it is drawn always, with the leaves, or in place of leaves that have fallen. */
  readonly season: "always" | "leafy" | "bare";
  /** Drawn of trees near the eye only. */
  readonly near: boolean;
}

/** In place of the first vertex of a part: its vertices are not those of the file in their order, and named by its joints. */
export const ADDED_PART = -1;

/** A part with the materials that it is drawn with. */
export interface DrawnPart extends PlannedPart {
  readonly materials: PartMaterials;
}

export interface ShadowOptions {
  /** Largest share of a tree's pieces that is drawn into shadow maps. */
  readonly share: number;
  /** How far from the eye (m) a caster can stand and still reach the map of a shadow camera; without it, anywhere. */
  reach_m?(shadowCamera: Camera): number;
}

/** Draws all trees of a species. */
export interface TreeMeshes {
  /** Takes the trees of a draw list. `texels`: where each level's are in the target of pass 1; null: trees that stand still. */
  fill(list: DrawList, instances: Float32Array, texels: readonly LevelTexels[] | null): void;
  /** Triangles of the last selection in the colour pass. */
  readonly visibleTriangles: number;
  /** Draws with these materials, one pair per part. */
  drawWith(materialsOf: (materials: PartMaterials) => PartMaterials): void;
  dispose(): void;
}

/** Draws all levels of detail of a part with one call (together/). */
export interface Together {
  /** What the materials of the parts need. */
  readonly uniforms: TogetherUniforms;
  /** Merges parts that can be drawn with one material. */
  merged(parts: readonly PlannedPart[]): PlannedPart[];
  /** Pass 1. */
  nodes(motion: DrawnMotion): TreeNodes;
  meshes(
    parts: readonly DrawnPart[],
    motion: DrawnMotion | null,
    shadows: ShadowOptions,
    group: Group,
  ): TreeMeshes;
}

/** Texels of trees that stand still. */
export const NO_TEXELS: LevelTexels = { first: 0, trees: Number.POSITIVE_INFINITY, nodes: 0 };
