/**
 * Pass 1 of WebGPURenderer: what trees/nodes/levelShader.ts does in GLSL, in TSL. Displacement and wind, and rotation, are two
 * textures of half floats, as wide together as the texel of WebGLRenderer.
 */
import { type DataTexture, FloatType, HalfFloatType, NearestFilter } from "three";
import {
  Break,
  clamp,
  Discard,
  dot,
  Fn,
  float,
  If,
  int,
  ivec2,
  Loop,
  length,
  max,
  mix,
  outputStruct,
  positionGeometry,
  property,
  screenCoordinate,
  texture,
  uniform,
  vec3,
  vec4,
} from "three/tsl";
import { type Node, NodeMaterial, RenderTarget, type TextureNode } from "three/webgpu";
import { LONGEST_LINK, MOST_LINK_STRETCH } from "../core/constants";
import type { NodeLevel } from "../core/table/drawnTable";
import { FLAT_SHIFT } from "../trees/nodes/flatTexture";
import { MOST_LINKS } from "../trees/nodes/levelShader";
import type { LevelTextures, TreeGraphics } from "../trees/nodes/nodeGraphics";
import { adapt } from "./geometry";
import type { Float, Vector } from "./turn";

type Int = Node<"int">;
type Quad = Node<"vec4">;

/** Texel i of a texture 2 ** shift texels wide. */
export const texelAt = (of: TextureNode, i: Int, shift: Int): Quad =>
  of.load(ivec2(i.bitAnd(int(1).shiftLeft(shift).sub(1)), i.shiftRight(shift)));

const flat = (of: TextureNode, i: Int): Quad => texelAt(of, i, int(FLAT_SHIFT));

/** A number that is read whenever something is drawn. */
export const live = (of: { readonly value: number }) => uniform(of.value).onRenderUpdate(() => of.value);

/** A material of one step, which draws whole texels. */
function materialOf(fragment: Node): NodeMaterial {
  const material = new NodeMaterial();
  material.vertexNode = vec4(positionGeometry, 1);
  material.fragmentNode = fragment;
  material.depthTest = false;
  material.depthWrite = false;
  return material;
}

/** TSL of one level. */
class LevelNodes {
  readonly uniforms;
  private readonly quads: number;
  private readonly nodes: number;
  private readonly windChannel: "x" | "y" | "z" | "w";
  private readonly factor: Float;

  constructor(
    level: NodeLevel,
    private readonly textures: LevelTextures,
    factor: { readonly value: number },
    private readonly eases: boolean,
  ) {
    const [, , , poses] = textures;
    this.quads = level.quads;
    this.nodes = level.nodes;
    this.windChannel = (["x", "y", "z", "w"] as const)[level.coordinates.length % 4];
    this.factor = live(factor);
    this.uniforms = {
      uPoses: texture(poses),
      uBefore: texture(poses),
      uShare: uniform(1),
      uShift: uniform(0, "int"),
      uRow: uniform(0, "int"),
      uDrawn: uniform(0, "int"),
    };
  }

  /** Tree and node of the texel that is drawn. */
  private place(): { slot: Int; node: Int } {
    const { uRow, uShift, uDrawn } = this.uniforms;
    const at = ivec2(screenCoordinate.xy);
    const i = at.y.sub(uRow).shiftLeft(uShift).add(at.x).toVar();
    const slot = i.div(this.nodes).toVar();
    If(slot.greaterThanEqual(uDrawn), () => {
      Discard();
    });
    return { slot, node: i.sub(slot.mul(this.nodes)).toVar() };
  }

  /** Sum of three rows of a node over the coordinates of its tree, and the wind at the tree. */
  private summed(slot: Int, node: Int, rows: DataTexture): { sum: Vector; wind: Float } {
    const { quads, uniforms } = this;
    const { uPoses, uBefore, uShare } = uniforms;
    const table = texture(rows);
    const sum = vec3(0).toVar();
    const q = vec4(0).toVar();
    Loop({ start: int(0), end: int(quads), type: "int" }, ({ i: k }) => {
      const at = slot.mul(quads).add(k).toVar();
      const newest = flat(uPoses, at);
      q.assign(this.eases ? mix(flat(uBefore, at), newest, uShare) : newest);
      const row = node
        .mul(3 * quads)
        .add(k)
        .toVar();
      const [x, y, z] = [0, 1, 2].map((axis) => dot(q, flat(table, row.add(axis * quads))));
      sum.addAssign(vec3(x, y, z));
    });
    return { sum: sum.mul(this.factor), wind: q[this.windChannel] };
  }

  displaced() {
    return Fn(() => {
      const { slot, node } = this.place();
      const { sum, wind } = this.summed(slot, node, this.textures[0]);
      return vec4(sum, wind);
    })();
  }

  shortened() {
    const [, turn, links, , moved] = this.textures;
    const { uRow, uShift } = this.uniforms;
    const turned = property("vec4");
    const finished = Fn(() => {
      const { slot, node } = this.place();
      const { sum, wind } = this.summed(slot, node, turn);
      const [first, chain] = [texture(moved), texture(links)];
      const tree = slot.mul(this.nodes).add(uRow.shiftLeft(uShift)).toVar();
      const movedAt = (of: Int) => texelAt(first, tree.add(of), uShift).xyz;
      const curl = sum.toVar();
      const own = movedAt(node).toVar();
      const drawn = own.toVar();
      Loop({ start: int(0), end: int(MOST_LINKS), type: "int" }, ({ i: k }) => {
        const link = flat(chain, node).toVar();
        const before = int(link.w.add(0.5)).toVar();
        If(before.equal(node), () => {
          Break();
        });
        const limb = movedAt(before).toVar();
        const now = link.xyz.add(own).sub(limb).toVar();
        const rest = length(link.xyz).toVar();
        const stretched = length(now).toVar();
        If(k.equal(0), () => {
          curl.divAssign(clamp(stretched.div(max(rest, 1e-9)), 1, MOST_LINK_STRETCH));
        });
        const most = rest.mul(LONGEST_LINK).div(max(stretched, 1e-9));
        drawn.subAssign(now.mul(max(0, float(1).sub(most))));
        own.assign(limb);
        node.assign(before);
      });
      turned.assign(vec4(curl, 0));
      return vec4(drawn, wind);
    });
    return outputStruct(finished(), turned);
  }
}

/** How WebGPURenderer draws trees, with WebGPU or WebGL 2. */
export const TSL_GRAPHICS: TreeGraphics = {
  target: (width, height, finished) =>
    new RenderTarget(width, height, {
      ...(finished ? { type: HalfFloatType, count: 2 } : { type: FloatType }),
      minFilter: NearestFilter,
      magFilter: NearestFilter,
      depthBuffer: false,
      generateMipmaps: false,
    }),
  steps: (...of) => {
    const level = new LevelNodes(...of);
    return [materialOf(level.displaced()), materialOf(level.shortened()), level.uniforms];
  },
  adapt,
};
