/** Pass 1: where every node of every drawn tree is now. One texel per node and tree: xyz in m, w = wind in m/s. */
import {
  BufferAttribute,
  BufferGeometry,
  Camera,
  GLSL3,
  HalfFloatType,
  Mesh,
  NearestFilter,
  RawShaderMaterial,
  RGBAFormat,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { type NodeLayout, nodeLayout } from "../nodeLayout";
import type { TableMotion } from "../worker/protocol";
import { FLAT_SHIFT, flatTexture } from "./flatTexture";

const vertexShader = /* glsl */ `
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
`;

const fragmentShader = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D uBasis;
uniform sampler2D uPoses;
uniform sampler2D uOrder;
uniform int uNodeCount;
uniform int uShift;
uniform int uDrawn;
out vec4 node;

vec4 flat_(sampler2D source, int i) {
  return texelFetch(source, ivec2(i & ((1 << FLAT_SHIFT) - 1), i >> FLAT_SHIFT), 0);
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int i = (texel.y << uShift) + texel.x;
  int slot = i / uNodeCount;
  if (slot >= uDrawn) discard;
  int tree = int(flat_(uOrder, slot).r + 0.5) * QUADS;
  int row = (i - slot * uNodeCount) * 3 * QUADS;
  vec4 q;
  vec3 moved = vec3(0.0);
  for (int k = 0; k < QUADS; k++) {
    q = flat_(uPoses, tree + k);
    moved.x += dot(q, flat_(uBasis, row + k));
    moved.y += dot(q, flat_(uBasis, row + QUADS + k));
    moved.z += dot(q, flat_(uBasis, row + 2 * QUADS + k));
  }
  node = vec4(moved, q[WIND_CHANNEL]);
}
`;

function fullScreenTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  return geometry;
}

export class NodePass {
  readonly target: WebGLRenderTarget;
  readonly layout: NodeLayout;
  /** Trees that the target holds; never more than asked for. */
  readonly capacity: number;
  private readonly basis;
  private readonly poses;
  private readonly order;
  private readonly mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  private readonly camera = new Camera();

  constructor(
    private readonly motion: TableMotion,
    readonly trees: number,
    maxSide: number,
  ) {
    this.layout = nodeLayout(motion.nodes, trees, maxSide);
    this.capacity = Math.min(trees, this.layout.capacity);
    const quads = motion.stride / 4;
    this.basis = flatTexture(motion.nodes * 3 * quads, 4);
    this.basis.data.set(motion.basis);
    this.poses = flatTexture(trees * quads, 4);
    this.order = flatTexture(trees, 1);
    this.target = new WebGLRenderTarget(this.layout.width, this.layout.height, {
      type: HalfFloatType,
      format: RGBAFormat,
      minFilter: NearestFilter,
      magFilter: NearestFilter,
      depthBuffer: false,
    });
    this.mesh = new Mesh(fullScreenTriangle(), this.material(quads));
    this.mesh.frustumCulled = false;
  }

  private material(quads: number): RawShaderMaterial {
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      depthTest: false,
      depthWrite: false,
      defines: { QUADS: quads, FLAT_SHIFT, WIND_CHANNEL: this.motion.modes % 4 },
      uniforms: {
        uBasis: { value: this.basis.texture },
        uPoses: { value: this.poses.texture },
        uOrder: { value: this.order.texture },
        uNodeCount: { value: this.motion.nodes },
        uShift: { value: this.layout.shift },
        uDrawn: { value: 0 },
      },
    });
  }

  /** The newest poses: `stride` floats per tree, as the worker wrote them. */
  setPoses(poses: Float32Array): void {
    this.poses.data.set(poses.subarray(0, Math.min(poses.length, this.trees * this.motion.stride)));
    this.poses.texture.needsUpdate = true;
  }

  /** Which tree stands in which slot of the target, for this frame's drawn trees. */
  setOrder(order: Uint32Array, drawn: number): void {
    this.order.data.set(order.subarray(0, drawn));
    this.order.texture.needsUpdate = true;
    this.mesh.material.uniforms.uDrawn.value = drawn;
  }

  render(renderer: WebGLRenderer): void {
    const drawn = this.mesh.material.uniforms.uDrawn.value as number;
    if (drawn === 0) return;
    const rows = Math.min(this.layout.height, Math.ceil((drawn * this.motion.nodes) / this.layout.width));
    this.target.viewport.set(0, 0, this.layout.width, rows);
    renderer.setRenderTarget(this.target);
    renderer.render(this.mesh, this.camera);
    renderer.setRenderTarget(null);
  }

  dispose(): void {
    this.target.dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    for (const flat of [this.basis, this.poses, this.order]) flat.texture.dispose();
  }
}
