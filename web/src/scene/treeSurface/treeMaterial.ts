/** Materials of one part of a species as the page draws it, for the colour and the shadow pass. */

import type { MaterialMaker, Part } from "galewood/trees";
import { deform, PULL_PARS, type SpeciesUniforms, TOGETHER_PARS, type Variant } from "galewood/trees";
import {
  CustomBlending,
  DoubleSide,
  FrontSide,
  type Material,
  MeshDepthMaterial,
  MeshLambertMaterial,
  MeshStandardMaterial,
  OneFactor,
  RGBADepthPacking,
  type Texture,
  ZeroFactor,
} from "three";
import { OTHER_LEAF_SHARE, SINGLE_ATTRIBUTES, SINGLE_LEAF_SHARE } from "./closeShader";
import { ALPHA_TEST } from "./leafColour";
import { type AtmosphereShader, patchColour, type SurfaceUniforms } from "./treeLight";

function sharpen(texture: Texture | null, anisotropy: number): Texture | null {
  if (texture) texture.anisotropy = anisotropy;
  return texture;
}

type TreeMaterial = MeshStandardMaterial | MeshLambertMaterial;

export interface MaterialOptions {
  readonly anisotropy: number;
  readonly smoothEdges: boolean;
  /** Relief of bark near the eye. */
  readonly relief: boolean;
  /** Gloss of bark; without it, shading costs about half. */
  readonly gloss: boolean;
  readonly surface: SurfaceUniforms;
  readonly atmosphere: AtmosphereShader;
}

/** Variant and uniforms of the colour pass, or of the shadow maps. */
function variantOf(
  part: Part,
  moves: boolean,
  key: string,
  { together, ...uniforms }: SpeciesUniforms,
  pass: "seen" | "casting",
  leafShare?: string,
): [Variant, object] {
  const variant: Variant = { part, moves, standing: "upright", key, pulls: PULL_PARS, leafShare };
  if (!together) return [variant, uniforms];
  return [
    { ...variant, key: `${key}-together`, together: TOGETHER_PARS },
    { ...uniforms, ...together[pass] },
  ];
}

/** Variant and uniforms of leaves that are drawn one by one. */
function singleLeaves(key: string, { together: _, ...uniforms }: SpeciesUniforms): [Variant, object] {
  const code = { pulls: PULL_PARS, leafShare: SINGLE_LEAF_SHARE, attributes: SINGLE_ATTRIBUTES };
  return [{ part: "leaves", moves: true, standing: "upright", key: `${key}-single`, ...code }, uniforms];
}

/** Deforms a material; with the extension that tells the draws of a call apart, as ShaderMaterial has it: three.js reads it of any. */
function deformed(
  material: Material,
  [variant, uniforms]: ReturnType<typeof variantOf>,
  further: object,
  patch?: Parameters<typeof deform>[3],
): void {
  if (variant.together) Object.assign(material, { extensions: { multiDraw: true } });
  deform(material, variant, { ...uniforms, ...further }, patch);
}

function colourMaterial(
  from: MeshStandardMaterial,
  part: Part,
  uniforms: SpeciesUniforms,
  options: MaterialOptions,
  moves: boolean,
  single = false,
): TreeMaterial {
  const leaves = part === "leaves";
  const cut = leaves && (from.alphaTest > 0 || from.transparent);
  const common = {
    map: sharpen(from.map, options.anisotropy),
    // Leaves have their relief from the gradient of their picture.
    normalMap: options.relief && !leaves ? sharpen(from.normalMap, options.anisotropy) : null,
    normalScale: from.normalScale,
    color: from.color,
    side: leaves ? DoubleSide : FrontSide,
    alphaTest: cut ? ALPHA_TEST : 0,
    alphaToCoverage: cut && options.smoothEdges,
  };
  // Leaves have a gloss of their own, which is cheaper: see treeLight.ts.
  const material =
    options.gloss && !leaves
      ? new MeshStandardMaterial({ ...common, roughness: 0.94, metalness: 0 })
      : new MeshLambertMaterial(common);
  if (leaves && options.smoothEdges) material.defines = { ...material.defines, CUTICLE: "" };
  if (single) material.defines = { ...material.defines, SINGLE_LEAVES: "" };
  if (from.userData.merged) material.defines = { ...material.defines, MERGED: "" };
  if (leaves && from.userData.evergreen) material.defines = { ...material.defines, EVERGREEN: "" };
  if (leaves && from.userData.shoots) material.defines = { ...material.defines, SHOOT_TILES: "" };
  if (material.alphaToCoverage) keepAlpha(material);
  const { surface, atmosphere } = options;
  const key = `colour-${atmosphere.key}`;
  const share = leaves && options.smoothEdges ? OTHER_LEAF_SHARE : undefined; // cards for all in shadow maps
  const drawn = single ? singleLeaves(key, uniforms) : variantOf(part, moves, key, uniforms, "seen", share);
  deformed(material, drawn, { ...atmosphere.uniforms, ...surface }, (shader) =>
    patchColour(shader, part, moves, atmosphere),
  );
  return material;
}

/** Alpha coverage must not make the canvas transparent: write only colour and keep the cleared alpha. */
function keepAlpha(material: Material): void {
  material.blending = CustomBlending;
  material.blendSrc = OneFactor;
  material.blendDst = ZeroFactor;
  material.blendSrcAlpha = ZeroFactor;
  material.blendDstAlpha = OneFactor;
}

function shadowMaterial(
  colour: TreeMaterial,
  part: Part,
  uniforms: SpeciesUniforms,
  { surface }: MaterialOptions,
  moves: boolean,
): MeshDepthMaterial {
  const material = new MeshDepthMaterial({
    depthPacking: RGBADepthPacking,
    map: colour.alphaTest > 0 ? colour.map : null,
    alphaTest: colour.alphaTest,
  });
  deformed(material, variantOf(part, moves, "depth", uniforms, "casting"), surface);
  return material;
}

/** Materials of a part that is deformed by its nodes, or is static at no extra cost. */
export const materialsOf =
  (options: MaterialOptions): MaterialMaker =>
  (from, part, uniforms, moves) => {
    const colour = colourMaterial(from, part, uniforms, options, moves);
    return { colour, shadow: shadowMaterial(colour, part, uniforms, options, moves) };
  };

/** The colour material of leaves that are drawn one by one, with the attributes of closeShader.ts. */
export function singlesMaterial(
  from: MeshStandardMaterial,
  uniforms: SpeciesUniforms,
  options: MaterialOptions,
): TreeMaterial {
  const material = colourMaterial(from, "leaves", uniforms, options, true, true);
  material.vertexColors = true;
  return material;
}
