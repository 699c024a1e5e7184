/**
 * All levels of detail of one species, each part drawn with one call per pass (WEBGL_multi_draw): a draw of the call is a level, or
 * what only trees near the eye show.
 */
import {
  BufferAttribute,
  type Group,
  InstancedBufferGeometry,
  type Material,
  Mesh,
  type WebGLRenderer,
} from "three";
import { LEVEL_SHARES } from "../../core/constants";
import type { DrawnMotion } from "../../core/table/drawnTable";
import { LEVEL_COUNT, MOST_SHARE } from "../detail";
import type { DrawList } from "../drawList";
import type { ShadowOptions } from "../drawnParts";
import { type DrawnPart, NO_TEXELS, type PlannedPart, type Together, type TreeMeshes } from "../drawnParts";
import { jointAttribute, pivotAttribute } from "../jointAttribute";
import type { LevelTexels, TreeNodes } from "../nodes/treeNodes";
import type { PartMaterials } from "../partMaterials";
import { mergedParts } from "./mergedParts";
import { TogetherNodes } from "./togetherNodes";
import { DRAWS_PER_CALL, NEAR_DRAW } from "./togetherShader";
import { TreeTable } from "./treeTable";

type TogetherMesh = Mesh<InstancedBufferGeometry, Material>;

/** Whether a renderer can draw trees together. */
export const drawsTogether = ({ extensions }: WebGLRenderer): boolean => extensions.has("WEBGL_multi_draw");

/** Indices of each draw: their number, and where they begin, bytes. */
interface Ranges {
  readonly counts: Int32Array;
  readonly offsets: Int32Array;
}

/** `levelOf`: whose indices a level is drawn with. */
function rangesOf({ part, near }: PlannedPart, levelOf: (level: number) => number): Ranges {
  const { index, counts: perLevel } = part;
  const counts = new Int32Array(DRAWS_PER_CALL);
  const offsets = new Int32Array(DRAWS_PER_CALL);
  if (!near) for (let level = 0; level < LEVEL_COUNT; level++) counts[level] = perLevel[levelOf(level)];
  const nearFrom = near ? 0 : perLevel[0];
  counts[NEAR_DRAW] = index.count - nearFrom;
  offsets[NEAR_DRAW] = Uint32Array.BYTES_PER_ELEMENT * nearFrom;
  return { counts, offsets };
}

const indicesOf = ({ counts }: Ranges, trees: Int32Array): number =>
  trees.reduce((sum, count, draw) => sum + count * counts[draw], 0);

/** Both nodes of the joint of each vertex at all levels, as attributes (togetherShader.ts). */
export function jointsOf({ part, firstVertex }: PlannedPart, motion: DrawnMotion) {
  const meshLevels = motion.levels.slice(0, LEVEL_COUNT);
  const perLevel = meshLevels.map((level) => jointAttribute(part, firstVertex, motion, level).array);
  const [finest] = perLevel;
  const joint = Uint16Array.from(finest, (value, i) =>
    i % 4 === 2 ? Math.max(...perLevel.map((joints) => joints[i])) : value,
  );
  const pair = (finer: number) => {
    const joints = new Uint16Array(4 * part.vertices);
    for (let v = 0; v < joints.length; v += 4) {
      joints.set([perLevel[finer][v], perLevel[finer][v + 1]], v);
      joints.set([perLevel[finer + 1][v], perLevel[finer + 1][v + 1]], v + 2);
    }
    return new BufferAttribute(joints, 4);
  };
  return { aJoints0: new BufferAttribute(joint, 4), aJoints12: pair(1), aJoints34: pair(3) };
}

function geometryOf(planned: PlannedPart, motion: DrawnMotion | null): InstancedBufferGeometry {
  const { part, firstVertex } = planned;
  const geometry = new InstancedBufferGeometry();
  geometry.instanceCount = 0; // three.js only prepares the call
  geometry.setIndex(part.index);
  geometry.setAttribute("position", part.position);
  geometry.setAttribute("normal", part.normal);
  if (part.uv) geometry.setAttribute("uv", part.uv);
  if (part.colour) geometry.setAttribute("color", part.colour);
  geometry.setAttribute("aAnchor", part.anchor);
  geometry.setAttribute("aPiece", part.piece);
  if (!motion) return geometry;
  geometry.setAttribute("aPivot", pivotAttribute(part, firstVertex, motion));
  for (const [name, joints] of Object.entries(jointsOf(planned, motion))) geometry.setAttribute(name, joints);
  return geometry;
}

interface TogetherPart {
  readonly mesh: TogetherMesh;
  readonly materials: PartMaterials;
  readonly seen: Ranges;
}

class TogetherMeshes implements TreeMeshes {
  private readonly parts: TogetherPart[];
  /** Trees of each draw. */
  private readonly seen = new Int32Array(DRAWS_PER_CALL);
  private readonly casting = new Int32Array(DRAWS_PER_CALL);
  private list: DrawList | null = null;

  constructor(
    parts: readonly DrawnPart[],
    motion: DrawnMotion | null,
    private readonly shadows: ShadowOptions,
    group: Group,
    private readonly tables: { readonly seen: TreeTable; readonly casting: TreeTable },
  ) {
    this.parts = parts.map((part) => this.drawn(part, motion));
    for (const { mesh } of this.parts) group.add(mesh);
  }

  private drawn(part: DrawnPart, motion: DrawnMotion | null): TogetherPart {
    const { materials } = part;
    const shadowLevel = LEVEL_SHARES.findLastIndex((share) => share >= this.shadows.share);
    const seen = rangesOf(part, (level) => level);
    const shadow = rangesOf(part, (level) => Math.max(level, shadowLevel));
    const mesh = new Mesh(geometryOf(part, motion), materials.colour);
    mesh.customDepthMaterial = materials.shadow;
    mesh.raycast = () => {}; // instances are picked by treePick.ts
    mesh.frustumCulled = false; // trees are culled individually
    mesh.matrixAutoUpdate = false;
    mesh.receiveShadow = true;
    mesh.castShadow = !part.near;
    // By then three.js has bound all that the call needs; it draws no instance itself.
    mesh.onAfterRender = (renderer) => this.draw(renderer, seen, this.seen);
    mesh.onAfterShadow = (renderer, _object, _camera, shadowCamera) => {
      const within_m = this.shadows.reach_m?.(shadowCamera) ?? Number.POSITIVE_INFINITY;
      this.draw(renderer, shadow, this.castersWithin(within_m));
    };
    return { mesh, materials, seen };
  }

  private castersWithin(distance_m: number): Int32Array {
    for (let level = 0; level < LEVEL_COUNT; level++)
      this.casting[level] = this.list?.castersWithin(level, distance_m) ?? 0;
    return this.casting;
  }

  private draw(renderer: WebGLRenderer, ranges: Ranges, trees: Int32Array): void {
    const indices = indicesOf(ranges, trees);
    if (indices === 0) return;
    const { TRIANGLES, UNSIGNED_INT } = renderer.getContext();
    const { counts, offsets } = ranges;
    const multi = renderer.extensions.get("WEBGL_multi_draw") as WEBGL_multi_draw;
    multi.multiDrawElementsInstancedWEBGL(
      TRIANGLES,
      counts,
      0,
      UNSIGNED_INT,
      offsets,
      0,
      trees,
      0,
      DRAWS_PER_CALL,
    );
    renderer.info.update(indices, TRIANGLES, 1);
  }

  fill(list: DrawList, instances: Float32Array, given: readonly LevelTexels[] | null): void {
    this.list = list;
    const texels = given ?? Array.from({ length: LEVEL_COUNT }, () => NO_TEXELS);
    const { seen, tables, shadows } = this;
    for (let level = 0; level < LEVEL_COUNT; level++)
      seen[level] = Math.min(list.visible[level], texels[level].trees);
    tables.seen.fill(list, instances, texels, {
      counts: seen,
      placeOf: (level, i) => list.start[level] + i,
      shares: list.share,
      mostShare: MOST_SHARE,
    });
    let near = 0;
    while (near < seen[0] && list.share[list.order[list.start[0] + near]] > 1) near++;
    seen[NEAR_DRAW] = near; // the first trees of the finest level
    tables.casting.fill(list, instances, texels, {
      counts: this.castersWithin(Number.POSITIVE_INFINITY),
      placeOf: (level, i) =>
        Math.min(list.casters[list.castStart[level] + i], list.start[level] + texels[level].trees - 1),
      shares: list.castShare,
      mostShare: shadows.share,
    });
    const casts = this.casting.some((count) => count > 0);
    for (const { mesh, seen: ranges } of this.parts) {
      mesh.visible = indicesOf(ranges, seen) > 0 || (mesh.castShadow && casts);
    }
  }

  get visibleTriangles(): number {
    const drawn = this.parts.filter(({ mesh }) => mesh.material.visible);
    return drawn.reduce((sum, { seen }) => sum + indicesOf(seen, this.seen) / 3, 0);
  }

  drawWith(materialsOf: (materials: PartMaterials) => PartMaterials): void {
    for (const { mesh, materials } of this.parts) {
      const { colour, shadow } = materialsOf(materials);
      mesh.material = colour;
      mesh.customDepthMaterial = shadow;
    }
  }

  dispose(): void {
    for (const { mesh } of this.parts) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    this.tables.seen.dispose();
    this.tables.casting.dispose();
  }
}

/**
 * Draws the levels of each species together, and pass 1 of all species; for renderers of which `drawsTogether` is true.
 *
 * `factor`: shared factor of all displacements.
 */
export function together(maxTextureSide: number, factor: { readonly value: number }): () => Together {
  let all: TogetherNodes | null = null;
  const nodes = (motion: DrawnMotion): TreeNodes => {
    if (!all?.hasRoomFor(motion) || all.isEmpty) all = new TogetherNodes(maxTextureSide, factor);
    return all.add(motion);
  };
  return () => {
    const tables = { seen: new TreeTable(), casting: new TreeTable() };
    return {
      uniforms: { seen: tables.seen.uniforms, casting: tables.casting.uniforms },
      merged: mergedParts,
      nodes,
      meshes: (parts, motion, shadows, group) => new TogetherMeshes(parts, motion, shadows, group, tables),
    };
  };
}
