/** Materials of impostors, for the colour and the shadow pass. */
import {
  DoubleSide,
  MeshDepthMaterial,
  MeshLambertMaterial,
  RGBADepthPacking,
  type Texture,
  Vector3,
} from "three";
import { exaggeration } from "../exaggeration";
import { seasonal } from "../season/seasonal";
import { air } from "../sky/air";
import type { Atlas } from "./baking/atlas";
import { patchCard, patchShadow } from "./cardShader";

/** Opacity below which a pixel of a crown is not drawn. */
const EDGE_ALPHA = 0.4;

/** Uniforms that all impostors share. */
export const shared = {
  /** 1 while the trees are bare, also where the pictures still have leaves. */
  uBare: { value: 0 },
  uTowardsSun: air.uSunWorld,
  uExaggeration: exaggeration,
};

const IN_LEAF = { value: 0 };

export interface CardUniforms {
  /** Nodes of the simulated trees of this species, or null. */
  readonly uNodes: { value: Texture | null };
  readonly uNodeShift: { value: number };
  /** Share of the newer displacement. */
  readonly uShare: { value: number };
}

function uniformsOf(
  { box, colour, surface, model }: Atlas,
  own: CardUniforms,
  crowded: number,
  middle: number,
) {
  const map = model.parts.find(({ kind, uv }) => kind === "leaves" && uv)?.material.map ?? null;
  return {
    ...air,
    ...seasonal,
    ...shared,
    ...own,
    uBare: model.evergreen ? IN_LEAF : shared.uBare,
    uColour: { value: colour.texture },
    uSurface: { value: surface.texture },
    uBoxM: { value: new Vector3(box.across_m, box.up_m, box.middle_m) },
    uLean: { value: model.leans ? 1 : 0 },
    uTree: { value: new Vector3(box.reach, box.height_m, middle) },
    uCrowded: { value: crowded },
    uLeafMap: { value: map },
    uMapped: { value: map ? 1 : 0 },
    uEdge: { value: EDGE_ALPHA },
  };
}

/** `middle`: height of the middle node relative to the tree's; null for trees that are not simulated. */
export function cardMaterials(atlas: Atlas, own: CardUniforms, middle: number | null) {
  const simulated = middle !== null;
  const defines = simulated ? "#define SIMULATED\n" : "";
  const uniforms = uniformsOf(atlas, own, simulated ? 0 : 0.55, middle ?? 0.5);
  const colour = new MeshLambertMaterial({ shadowSide: DoubleSide }); // cards have no back that could cast the shadow
  colour.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    patchCard(shader, defines);
  };
  colour.customProgramCacheKey = () => `galewood-card-${simulated}`;
  const shadow = new MeshDepthMaterial({ depthPacking: RGBADepthPacking });
  shadow.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    patchShadow(shader, defines);
  };
  shadow.customProgramCacheKey = () => `galewood-card-shadow-${simulated}`;
  return { colour, shadow };
}
