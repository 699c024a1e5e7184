/** What pass 1 needs of a renderer. Types only: each renderer's part is made apart, so that pages load one of them. */
import type {
  DataTexture,
  InstancedBufferGeometry,
  Material,
  RenderTarget,
  Texture,
  WebGLRenderer,
} from "three";
import type { NodeLevel } from "../../core/table/drawnTable";

/** What the steps of a level read. */
export type LevelTextures = readonly [
  /** Rows [nodes, 3, 4 quads] by which the coordinates add up to displacements and to rotation vectors. */
  basis: DataTexture,
  turn: DataTexture,
  /** Per node: vector from the node before it at rest, and the index of that. */
  links: DataTexture,
  /** Coordinates of the drawn trees, 4 quads each. */
  poses: DataTexture,
  /** What the first step draws. */
  moved: Texture,
];

/** What changes from frame to frame. */
export interface LevelUniforms {
  readonly uPoses: { value: Texture };
  readonly uBefore: { value: Texture };
  /** Share of the newest poses in the blend. */
  readonly uShare: { value: number };
  /** log2 of the width of the target, its first row of this level, and the trees that are drawn. */
  readonly uShift: { value: number };
  readonly uRow: { value: number };
  readonly uDrawn: { value: number };
}

/** Materials of the two steps of a level: one adds up displacements, the other shortens links, and adds rotations and wind. */
export type LevelSteps = readonly [displacing: Material, shortening: Material, uniforms: LevelUniforms];

/** Targets and materials of pass 1, and what else depends on the renderer. */
export interface TreeGraphics {
  /** Target of the first step, or the `finished` one, which the trees read: one texture, or that of the rotations apart. */
  target(width: number, height: number, finished: boolean): RenderTarget;
  /** `factor`: of all displacements. `eases`: whether poses are blended with those before them. */
  steps(
    level: NodeLevel,
    textures: LevelTextures,
    factor: { readonly value: number },
    eases: boolean,
  ): LevelSteps;
  /** Changes the geometry of trees whenever its attributes are set. */
  adapt?(geometry: InstancedBufferGeometry): void;
}

/** What draws pass 1: WebGLRenderer or WebGPURenderer, which the types of three.js do not tell apart in callbacks. */
export type NodeRenderer = Pick<
  WebGLRenderer,
  "autoClear" | "getRenderTarget" | "setRenderTarget" | "render"
>;
