/** Levels of detail of one species, each drawn apart: instanced meshes for the colour pass and for the shadow pass. */
import {
  type BufferAttribute,
  DynamicDrawUsage,
  type Group,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  type Material,
  Mesh,
} from "three";
import { LEVEL_SHARES } from "../core/constants";
import type { DrawnMotion } from "../core/table/drawnTable";
import { MOST_SHARE } from "./detail";
import type { DrawList } from "./drawList";
import { type DrawnPart, NO_TEXELS, type ShadowOptions, type TreeMeshes } from "./drawnParts";
import { copyTree, INSTANCE_FLOATS, roomFor } from "./instanceData";
import { jointAttribute, pivotAttribute } from "./jointAttribute";
import type { TreePart } from "./mesh/treeMesh";
import type { TreeGraphics } from "./nodes/nodeGraphics";
import type { LevelTexels } from "./nodes/treeNodes";
import type { PartMaterials } from "./partMaterials";

/** A part at this level: triangles sorted by rank, and the joint of each vertex. */
interface LevelPart {
  readonly part: TreePart;
  /** Drawn of the nearest trees only, those that show a share of pieces above 1. */
  readonly near: boolean;
  /** Nodes and share of each vertex's joint, and its place; null: the tree stands still. */
  readonly joint: BufferAttribute | null;
  readonly pivot: BufferAttribute | null;
  readonly materials: PartMaterials;
}

type InstancedMesh = Mesh<InstancedBufferGeometry, Material>;

function geometryOf({ part, joint, pivot }: LevelPart, level: number) {
  const geometry = new InstancedBufferGeometry();
  geometry.setIndex(part.index);
  geometry.setDrawRange(0, part.counts[level]);
  geometry.setAttribute("position", part.position);
  geometry.setAttribute("normal", part.normal);
  if (part.uv) geometry.setAttribute("uv", part.uv);
  if (part.colour) geometry.setAttribute("color", part.colour);
  geometry.setAttribute("aAnchor", part.anchor);
  geometry.setAttribute("aPiece", part.piece);
  if (joint) geometry.setAttribute("aJoint", joint);
  if (pivot) geometry.setAttribute("aPivot", pivot);
  return geometry;
}

function setInstances(geometry: InstancedBufferGeometry, instances: InstancedInterleavedBuffer): void {
  ["aPlace", "aTurn", "aTint"].forEach((name, k) => {
    geometry.setAttribute(name, new InterleavedBufferAttribute(instances, 4, k * 4));
  });
}

function instancesFor(trees: number): InstancedInterleavedBuffer {
  const buffer = new InstancedInterleavedBuffer(new Float32Array(trees * INSTANCE_FLOATS), INSTANCE_FLOATS);
  buffer.setUsage(DynamicDrawUsage);
  return buffer;
}

interface LevelMesh {
  readonly mesh: InstancedMesh;
  readonly materials: PartMaterials;
  readonly caster: boolean;
  readonly near: boolean;
}

class LevelMeshes {
  private seen = instancesFor(0);
  private casting = instancesFor(0);
  private readonly meshes: LevelMesh[] = [];
  private visible = 0;
  /** Number of those that show near parts, which come first. */
  private near = 0;
  private casters = 0;
  private castersWithin: (distance_m: number) => number = () => 0;
  constructor(
    private readonly level: number,
    parts: readonly LevelPart[],
    private readonly shadows: ShadowOptions,
    group: Group,
    private readonly adapt: TreeGraphics["adapt"],
  ) {
    const shadowLevel = Math.max(
      level,
      LEVEL_SHARES.findLastIndex((share) => share >= shadows.share),
    );
    for (const part of parts) {
      group.add(this.colourMesh(part));
      if (!part.near) group.add(this.shadowMesh(part, shadowLevel));
    }
  }

  private mesh(part: LevelPart, level: number, caster: boolean): InstancedMesh {
    const geometry = geometryOf(part, level);
    setInstances(geometry, caster ? this.casting : this.seen);
    this.adapt?.(geometry);
    const mesh = new Mesh(geometry, part.materials.colour);
    mesh.customDepthMaterial = part.materials.shadow;
    if (part.materials.distance) mesh.customDistanceMaterial = part.materials.distance;
    mesh.raycast = () => {}; // instances are picked by treePick.ts
    mesh.frustumCulled = false; // trees are culled individually
    mesh.matrixAutoUpdate = false;
    mesh.castShadow = caster;
    this.meshes.push({ mesh, materials: part.materials, caster, near: part.near });
    return mesh;
  }

  private colourMesh(part: LevelPart): InstancedMesh {
    const mesh = this.mesh(part, this.level, false);
    mesh.renderOrder = this.level;
    mesh.receiveShadow = true;
    mesh.onBeforeRender = () => {
      mesh.geometry.instanceCount = part.near ? this.near : this.visible;
    };
    return mesh;
  }

  /** Mesh for the shadow maps only, each with the casters that can reach it. */
  private shadowMesh(part: LevelPart, level: number): InstancedMesh {
    const mesh = this.mesh(part, level, true);
    mesh.onBeforeShadow = (_renderer, _object, _camera, shadowCamera) => {
      const within_m = this.shadows.reach_m?.(shadowCamera) ?? Number.POSITIVE_INFINITY;
      mesh.geometry.instanceCount = this.castersWithin(within_m);
    };
    const hide = () => {
      mesh.geometry.instanceCount = 0;
    };
    hide();
    mesh.onAfterShadow = hide;
    return mesh;
  }

  /** Takes the level's trees from a draw list. */
  fill(list: DrawList, data: Float32Array, texels: LevelTexels): void {
    const { level } = this;
    const start = list.start[level];
    this.visible = Math.min(list.visible[level], texels.trees);
    this.seen = this.withRoom(this.seen, this.visible, false);
    this.copy(this.seen, data, list, texels, this.visible, list.share, (i) => start + i);
    this.near = 0;
    while (this.near < this.visible && list.share[list.order[start + this.near]] > 1) this.near++;
    const castStart = list.castStart[level];
    this.casters = list.castersWithin(level, Number.POSITIVE_INFINITY);
    this.castersWithin = (distance_m) => list.castersWithin(level, distance_m);
    const casterAt = (i: number) => Math.min(list.casters[castStart + i], start + texels.trees - 1);
    this.casting = this.withRoom(this.casting, this.casters, true);
    this.copy(this.casting, data, list, texels, this.casters, list.castShare, casterAt);
    for (const one of this.meshes) one.mesh.visible = this.countOf(one) > 0;
  }

  /** The buffer, or a larger one in its place if it cannot hold so many trees. */
  private withRoom(
    buffer: InstancedInterleavedBuffer,
    trees: number,
    casting: boolean,
  ): InstancedInterleavedBuffer {
    if (trees <= buffer.count) return buffer;
    const larger = instancesFor(roomFor(trees));
    for (const { mesh, caster } of this.meshes) {
      if (caster !== casting) continue;
      mesh.geometry.dispose(); // what has been drawn is bound to the former buffer
      setInstances(mesh.geometry, larger);
      this.adapt?.(mesh.geometry);
    }
    return larger;
  }

  private copy(
    buffer: InstancedInterleavedBuffer,
    data: Float32Array,
    list: DrawList,
    { first, nodes }: LevelTexels,
    count: number,
    shares: Float32Array,
    placeOf: (i: number) => number,
  ): void {
    const array = buffer.array as Float32Array;
    const start = list.start[this.level];
    const mostShare = buffer === this.casting ? this.shadows.share : MOST_SHARE;
    for (let i = 0; i < count; i++) {
      const place = placeOf(i);
      const tree = list.order[place];
      const texel = first + (place - start) * nodes;
      copyTree(data, tree, array, i * INSTANCE_FLOATS, texel, Math.min(mostShare, shares[tree]));
    }
    buffer.clearUpdateRanges();
    buffer.addUpdateRange(0, count * INSTANCE_FLOATS);
    buffer.needsUpdate = count > 0;
  }

  private countOf({ caster, near }: LevelMesh): number {
    if (caster) return this.casters;
    return near ? this.near : this.visible;
  }

  get visibleTriangles(): number {
    const seen = this.meshes.filter(({ mesh, caster }) => !caster && mesh.material.visible);
    return seen.reduce((sum, one) => sum + (one.mesh.geometry.drawRange.count / 3) * this.countOf(one), 0);
  }

  /** Draws with these materials, one pair per part. */
  drawWith(materialsOf: (materials: PartMaterials) => PartMaterials): void {
    for (const { mesh, materials } of this.meshes) {
      const used = materialsOf(materials);
      mesh.material = used.colour;
      mesh.customDepthMaterial = used.shadow;
      if (used.distance) mesh.customDistanceMaterial = used.distance;
    }
  }

  dispose(): void {
    for (const { mesh } of this.meshes) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
  }
}

/** Draws every level apart. */
export class ApartMeshes implements TreeMeshes {
  private readonly levels: LevelMeshes[];

  constructor(
    parts: readonly DrawnPart[],
    motion: DrawnMotion | null,
    shadows: ShadowOptions,
    group: Group,
    adapt: TreeGraphics["adapt"],
  ) {
    const pivots = parts.map(({ part, firstVertex }) => motion && pivotAttribute(part, firstVertex, motion));
    this.levels = LEVEL_SHARES.map((_, level) => {
      const own = parts.flatMap(({ part, firstVertex, near, materials }, k): LevelPart[] => {
        if (near && level > 0) return [];
        const joint = motion && jointAttribute(part, firstVertex, motion, motion.levels[level]);
        return [{ part, near, joint, pivot: pivots[k], materials }];
      });
      return new LevelMeshes(level, own, shadows, group, adapt);
    });
  }

  fill(list: DrawList, instances: Float32Array, texels: readonly LevelTexels[] | null): void {
    for (const [k, level] of this.levels.entries()) level.fill(list, instances, texels?.[k] ?? NO_TEXELS);
  }

  get visibleTriangles(): number {
    return this.levels.reduce((sum, level) => sum + level.visibleTriangles, 0);
  }

  drawWith(materialsOf: (materials: PartMaterials) => PartMaterials): void {
    for (const level of this.levels) level.drawWith(materialsOf);
  }

  dispose(): void {
    for (const level of this.levels) level.dispose();
  }
}
