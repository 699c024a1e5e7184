/** All trees of one species: pass 1 for its nodes, instanced meshes at three levels of detail for pass 2. */
import {
  BufferAttribute,
  DataTexture,
  DynamicDrawUsage,
  FloatType,
  Group,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  Mesh,
  type WebGLRenderer,
} from "three";
import type { TableMotion } from "../worker/protocol";
import { NodePass } from "./nodePass";
import {
  type DrawList,
  INSTANCE_FLOATS,
  LEVEL_COUNT,
  makeDrawList,
  type Stand,
  selectTrees,
  type View,
} from "./stand";
import { colourMaterial, type MaterialOptions, shadowMaterial } from "./treeMaterial";
import type { TreeModel, TreePart } from "./treeMesh";
import type { TreeUniforms } from "./treeShader";

export interface SpeciesOptions extends MaterialOptions {
  readonly maxTextureSide: number;
  /** Shared clock and amplitude of the flutter of leaves. */
  readonly flutter: { value: { x: number; y: number } };
}

function stillNode(): DataTexture {
  const texture = new DataTexture(new Float32Array(4), 1, 1, undefined, FloatType);
  texture.needsUpdate = true;
  return texture;
}

/** Node of each vertex of one part, as floats; zeros for a tree that stands still. */
function nodeAttribute(part: TreePart, firstVertex: number, motion: TableMotion | null): BufferAttribute {
  const nodes =
    motion?.vertexNode.slice(firstVertex, firstVertex + part.vertices) ?? new Uint16Array(part.vertices);
  return new BufferAttribute(nodes, 1);
}

export class SpeciesForest {
  readonly group = new Group();
  readonly stand: Stand;
  /** Triangles drawn into the picture by the last selection. */
  triangles = 0;
  private readonly nodes: NodePass | null;
  private readonly still = stillNode();
  private readonly uniforms: TreeUniforms;
  private readonly levels: { buffer: InstancedInterleavedBuffer; meshes: Mesh<InstancedBufferGeometry>[] }[];
  private readonly list: DrawList;
  private readonly classes: Uint8Array;
  private readonly disposables: { dispose(): void }[] = [];

  /** `motion` null: the trees stand still, in the grey of work in progress. */
  constructor(
    readonly model: TreeModel,
    readonly motion: TableMotion | null,
    stand: Stand,
    options: SpeciesOptions,
  ) {
    this.stand = stand;
    this.nodes = motion && stand.count > 0 ? new NodePass(motion, stand.count, options.maxTextureSide) : null;
    this.uniforms = {
      uNodes: { value: this.nodes?.target.texture ?? this.still },
      uNodeCount: { value: this.nodes ? (motion?.nodes ?? 0) : 0 },
      uNodeShift: { value: this.nodes?.layout.shift ?? 0 },
      uFlutter: options.flutter,
      uGhost: { value: motion ? 0 : 1 },
    };
    this.list = makeDrawList(stand.count);
    this.classes = new Uint8Array(stand.count);
    this.levels = Array.from({ length: LEVEL_COUNT }, () => ({
      buffer: new InstancedInterleavedBuffer(
        new Float32Array(stand.count * INSTANCE_FLOATS),
        INSTANCE_FLOATS,
      ),
      meshes: [],
    }));
    for (const { buffer } of this.levels) buffer.setUsage(DynamicDrawUsage);
    this.addParts(options);
  }

  private addParts(options: SpeciesOptions): void {
    let firstVertex = 0;
    for (const part of this.model.parts) {
      const colour = colourMaterial(part.material, part.kind, this.uniforms, options);
      const shadow = shadowMaterial(colour, part.kind, this.uniforms);
      const node = nodeAttribute(part, firstVertex, this.motion);
      firstVertex += part.vertices;
      this.disposables.push(colour, shadow);
      for (let level = 0; level < LEVEL_COUNT; level++) {
        const mesh = new Mesh(this.geometry(part, level, node), colour);
        mesh.customDepthMaterial = shadow;
        this.adopt(mesh, level);
      }
    }
  }

  private geometry(part: TreePart, level: number, node: BufferAttribute): InstancedBufferGeometry {
    const geometry = new InstancedBufferGeometry();
    geometry.setIndex(part.levels[level].index);
    geometry.setAttribute("position", part.levels[level].position);
    geometry.setAttribute("normal", part.normal);
    if (part.uv) geometry.setAttribute("uv", part.uv);
    geometry.setAttribute("aPiece", part.piece);
    geometry.setAttribute("aNode", node);
    const { buffer } = this.levels[level];
    ["aPlace", "aTurn", "aTint"].forEach((name, k) => {
      geometry.setAttribute(name, new InterleavedBufferAttribute(buffer, 4, k * 4));
    });
    this.disposables.push(geometry);
    return geometry;
  }

  /** Colour draws the visible trees; the shadow pass also those whose shadow falls into view. */
  private adopt(mesh: Mesh<InstancedBufferGeometry>, level: number): void {
    mesh.frustumCulled = false;
    mesh.renderOrder = level;
    mesh.castShadow = true;
    mesh.receiveShadow = true;
    mesh.matrixAutoUpdate = false;
    mesh.onBeforeShadow = () => {
      mesh.geometry.instanceCount = this.list.visible[level] + this.list.shadowOnly[level];
    };
    mesh.onBeforeRender = () => {
      mesh.geometry.instanceCount = this.list.visible[level];
    };
    this.levels[level].meshes.push(mesh);
    this.group.add(mesh);
  }

  /** Chooses what is drawn from this view, and at which level. */
  select(view: View): void {
    const bounds = { height_m: this.model.height_m, radius_m: this.model.radius_m };
    selectTrees(this.stand, bounds, view, this.classes, this.list);
    this.triangles = 0;
    for (let level = 0; level < LEVEL_COUNT; level++) this.fillLevel(level);
    this.nodes?.setOrder(this.list.order, Math.min(this.list.drawn, this.nodes.capacity));
  }

  private fillLevel(level: number): void {
    const { buffer, meshes } = this.levels[level];
    const start = this.list.start[level];
    const count = this.list.visible[level] + this.list.shadowOnly[level];
    const array = buffer.array as Float32Array;
    for (let i = 0; i < count; i++) {
      const from = this.list.order[start + i] * INSTANCE_FLOATS;
      array.set(this.stand.data.subarray(from, from + INSTANCE_FLOATS), i * INSTANCE_FLOATS);
      array[i * INSTANCE_FLOATS + 3] = start + i;
    }
    buffer.clearUpdateRanges();
    buffer.addUpdateRange(0, count * INSTANCE_FLOATS);
    buffer.needsUpdate = true;
    for (const mesh of meshes) {
      mesh.visible = count > 0;
      this.triangles += ((mesh.geometry.index?.count ?? 0) / 3) * this.list.visible[level];
    }
  }

  setPoses(poses: Float32Array): void {
    this.nodes?.setPoses(poses);
  }

  renderNodes(renderer: WebGLRenderer): void {
    this.nodes?.render(renderer);
  }

  dispose(): void {
    this.group.removeFromParent();
    this.nodes?.dispose();
    this.still.dispose();
    for (const disposable of this.disposables) disposable.dispose();
  }
}
