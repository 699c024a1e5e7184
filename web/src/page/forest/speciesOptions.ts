/** How trees are drawn at a quality. */
import {
  drawsTogether,
  GLSL_GRAPHICS,
  LEVEL_SHARES,
  PullSlots,
  type SpeciesOptions,
  together,
} from "galewood/trees";
import { exaggeration } from "../../scene/exaggeration";
import type { Quality } from "../../scene/quality";
import { seasonal } from "../../scene/season/seasonal";
import { aerialPerspective } from "../../scene/sky/air";
import { cascadeReach_m } from "../../scene/sky/daylight";
import type { Stage } from "../../scene/stage";
import { SingleLeafMeshes } from "../../scene/treeSurface/closeLeaves";
import { type MaterialOptions, materialsOf } from "../../scene/treeSurface/treeMaterial";

/** `flutter`: clock and amplitude of the flutter of leaves. */
export function speciesOptions(
  quality: Quality,
  { renderer }: Stage,
  flutter: SpeciesOptions["flutter"],
): SpeciesOptions {
  const { capabilities } = renderer;
  const maxTextureSide = Math.min(capabilities.maxTextureSize, 4096);
  const surfaces: MaterialOptions = {
    anisotropy: quality === "low" ? 1 : Math.min(4, capabilities.getMaxAnisotropy()),
    smoothEdges: quality !== "low",
    relief: quality !== "low",
    gloss: quality === "high",
    surface: seasonal,
    atmosphere: aerialPerspective,
  };
  return {
    materials: materialsOf(surfaces),
    closeLeaves: (model, motion, uniforms, group) =>
      new SingleLeafMeshes(model, motion, uniforms, surfaces, group),
    graphics: GLSL_GRAPHICS,
    maxTextureSide,
    // If gloss is affordable, so are the shadows of all leaves.
    shadows: { share: quality === "high" ? 1 : LEVEL_SHARES[1], reach_m: cascadeReach_m },
    fine: quality !== "low",
    ...(drawsTogether(renderer) && { together: together(maxTextureSide, exaggeration) }),
    pullsOf: (holds) => new PullSlots(holds),
    flutter,
    exaggeration,
  };
}
