/** Pass 1 of WebGLRenderer: packs a finished texel (nodeTexel.ts) into one texture of whole numbers. */
import {
  GLSL3,
  NearestFilter,
  RawShaderMaterial,
  RGBAIntegerFormat,
  UnsignedIntType,
  WebGLRenderTarget,
} from "three";
import type { NodeLevel } from "../../core/table/drawnTable";
import { FLAT_SHIFT } from "./flatTexture";
import { COVER_GLSL, DISPLACE_GLSL, SHORTEN_GLSL } from "./levelShader";
import type { LevelSteps, LevelTextures, TreeGraphics } from "./nodeGraphics";

/** A target of pass 1. */
export const uintTarget = (width: number, height: number) =>
  new WebGLRenderTarget(width, height, {
    type: UnsignedIntType,
    format: RGBAIntegerFormat,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthBuffer: false,
  });

function steps(
  level: NodeLevel,
  [basis, turn, links, poses, moved]: LevelTextures,
  factor: { readonly value: number },
  eases: boolean,
): LevelSteps {
  const shared = {
    uPoses: { value: poses },
    uBefore: { value: poses },
    uShare: { value: 1 },
    uFactor: factor,
    uNodeCount: { value: level.nodes },
    uShift: { value: 0 },
    uRow: { value: 0 },
    uDrawn: { value: 0 },
  };
  const material = (fragmentShader: string, own: RawShaderMaterial["uniforms"]) =>
    new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: COVER_GLSL,
      fragmentShader,
      depthTest: false,
      depthWrite: false,
      defines: {
        QUADS: level.quads,
        FLAT_SHIFT,
        WIND_CHANNEL: level.coordinates.length % 4,
        ...(eases && { BLEND: 1 }),
      },
      uniforms: { ...shared, ...own },
    });
  return [
    material(DISPLACE_GLSL, { uRows: { value: basis } }),
    material(SHORTEN_GLSL, { uRows: { value: turn }, uMoved: { value: moved }, uLinks: { value: links } }),
    shared,
  ];
}

export const GLSL_GRAPHICS: TreeGraphics = { target: uintTarget, steps };
