/** All trees of one species: pass 1 for its nodes, instanced meshes at every level of detail for pass 2. */
import { type BufferAttribute, Group } from "three";
import { LEVEL_SHARES } from "../core/constants";
import type { Easing } from "../core/motion/easedPoses";
import type { DrawnMotion } from "../core/table/drawnTable";
import { type Bounds, orientedBounds } from "./culling/culling";
import { LEVEL_COUNT } from "./detail";
import { DrawList, type View } from "./drawList";
import type { FarCards } from "./farCards";
import type { InstanceData } from "./instanceData";
import { jointAttribute, pivotAttribute } from "./jointAttribute";
import { MOST_LEAN } from "./lean";
import { LevelMeshes, type LevelPart, type LevelTexels, type ShadowOptions } from "./levelMeshes";
import type { AddedPart, TreeModel, TreePart } from "./mesh/treeMesh";
import type { NodeRenderer, TreeGraphics } from "./nodes/nodeGraphics";
import { NodePass } from "./nodes/nodePass";
import type { MaterialMaker, PartMaterials } from "./partMaterials";
import type { PullSlots, ShownPull } from "./pull/pullSlots";
import { jointRadii } from "./treePick";
import type { TreeUniforms } from "./treeShader";

export interface SpeciesOptions {
  readonly materials: MaterialMaker;
  /** What depends on the renderer. */
  readonly graphics: TreeGraphics;
  readonly maxTextureSide: number;
  readonly shadows: ShadowOptions;
  /** Draws near parts, and fine shoots in place of fallen leaves; without smoothed edges they would be specks. */
  readonly fine: boolean;
  /** What shows pulled branches, by the vertex whose motion each vertex takes; without it they are not shown. */
  pullsOf?(holds: Uint32Array): PullSlots;
  /** Shared clock and amplitude of the flutter of leaves. */
  readonly flutter: { value: { x: number; y: number } };
  /** Shared factor of all displacements on screen. */
  readonly exaggeration: { value: number };
}

/** In place of the first vertex of a part: it is added to those of the file, and named by its joints. */
const ADDED_PART = -1;
const ALL_TREES: LevelTexels = { first: 0, trees: Number.POSITIVE_INFINITY, nodes: 0 };

/** For each vertex of all parts, the vertex whose motion it takes. */
function holdsOf(model: TreeModel): Uint32Array {
  const holds = new Uint32Array(model.parts.reduce((sum, { vertices }) => sum + vertices, 0));
  let first = 0;
  for (const { hold, vertices } of model.parts) {
    for (let v = 0; v < vertices; v++) holds[first + v] = first + hold[v];
    first += vertices;
  }
  return holds;
}

interface OwnPart {
  readonly part: TreePart;
  readonly firstVertex: number;
  /** Whether it is drawn always, with the leaves, or in place of leaves that have fallen. */
  readonly season: "always" | "leafy" | "bare";
  /** Drawn of trees near the eye only. */
  readonly near: boolean;
  /** Shared by all levels; null: the tree stands still. */
  readonly pivot: BufferAttribute | null;
  readonly moving: PartMaterials | null;
  /** Materials without any deformation, created on first use. */
  still: PartMaterials | null;
}

/** `Motion`: what is known of the motion besides what drawing needs. */
export class SpeciesForest<Motion extends DrawnMotion = DrawnMotion> {
  readonly group = new Group();
  private readonly nodes: NodePass | null;
  private readonly pulls: PullSlots | null;
  private readonly uniforms: TreeUniforms;
  private readonly parts: OwnPart[];
  private readonly levels: LevelMeshes[];
  private list: DrawList;
  private frozen = false;
  private fallen = false;
  private jointRadius_m: Float32Array | null = null;
  /** Impostors of distant trees, if the scene has any. */
  cards: FarCards | null = null;

  /** Without `motion` the trees stand still. */
  constructor(
    readonly model: TreeModel,
    readonly motion: Motion | null,
    public instances: InstanceData,
    readonly options: SpeciesOptions,
  ) {
    const { graphics, maxTextureSide, exaggeration } = options;
    this.nodes = motion ? new NodePass(motion, graphics, maxTextureSide, exaggeration) : null;
    this.pulls = options.pullsOf?.(holdsOf(model)) ?? null;
    this.uniforms = {
      ...this.pulls?.uniforms,
      uNodes: { value: this.nodes?.target.texture ?? null },
      uNodeShift: { value: 0 },
      uLean: { value: model.leans ? 1 : 0 },
      uFlutter: options.flutter,
      uExaggeration: options.exaggeration,
    };
    this.parts = this.makeParts();
    this.levels = LEVEL_SHARES.map((_, level) => this.makeLevel(level));
    this.list = new DrawList(instances);
  }

  private makeParts(): OwnPart[] {
    const { parts: read, added } = this.model;
    let firstVertex = 0;
    const parts = read.map((part) => {
      const own = this.ownPart(part, firstVertex, firstVertex);
      firstVertex += part.vertices;
      return own;
    });
    const held = ({ part, of }: AddedPart) => this.ownPart(part, parts[of].firstVertex, ADDED_PART);
    const always = [...parts, ...added.map(held)];
    if (!this.options.fine) return always;
    const { bare, near } = this.model; // made now
    const inLeaf = near.map((one): OwnPart => ({ ...held(one), season: "leafy", near: true }));
    return [...always, ...inLeaf, ...bare.map((one): OwnPart => ({ ...held(one), season: "bare" }))];
  }

  /** `pullFirst`: as for `materials`. */
  private ownPart(part: TreePart, firstVertex: number, pullFirst: number): OwnPart {
    return {
      part,
      firstVertex,
      season: part.kind === "leaves" ? "leafy" : "always",
      near: false,
      pivot: this.motion && pivotAttribute(part, firstVertex, this.motion),
      moving: this.motion ? this.materials(part, true, pullFirst) : null,
      still: this.motion ? null : this.materials(part, false, pullFirst),
    };
  }

  /** `pullFirst`: first vertex of the part in the fields of pulled points, or `ADDED_PART`. */
  private materials(part: TreePart, moves: boolean, pullFirst: number): PartMaterials {
    const uniforms = { ...this.uniforms, uPullFirst: { value: pullFirst } };
    const materials = this.options.materials(part.material, part.kind, uniforms, moves);
    materials.colour.vertexColors = part.colour !== null;
    return materials;
  }

  private makeLevel(level: number): LevelMeshes {
    const drawn = this.parts.filter(({ near }) => level === 0 || !near);
    const parts = drawn.map(({ part, firstVertex, near, pivot, moving, still }): LevelPart => {
      const materials = moving ?? still;
      if (!materials) throw new Error("a part without materials");
      const { motion } = this;
      const joint = motion && jointAttribute(part, firstVertex, motion, motion.levels[level]);
      return { part, near, joint, pivot, materials };
    });
    const { shadows, graphics } = this.options;
    return new LevelMeshes(level, parts, shadows, this.group, graphics.adapt);
  }

  /** Replaces the instances; trees that stay keep their level of detail. */
  setInstances(instances: InstanceData): void {
    const before = this.list;
    const known = new Map(Array.from(this.instances.ids, (id, tree) => [id, tree] as const));
    this.instances = instances;
    this.list = new DrawList(instances);
    instances.ids.forEach((id, tree) => {
      const old = known.get(id);
      if (old !== undefined) this.list.level[tree] = before.level[old];
    });
  }

  get leafless(): boolean {
    return this.fallen;
  }

  /** Whether the leaves are not drawn, because they have fallen; evergreens keep theirs. */
  set leafless(leafless: boolean) {
    this.fallen = leafless && !this.model.evergreen;
    for (const { season, moving, still } of this.parts) {
      const visible = season === "always" || season === (this.fallen ? "bare" : "leafy");
      for (const materials of [moving, still]) if (materials) materials.colour.visible = visible;
    }
  }

  private get exaggeration(): number {
    return this.options.exaggeration.value;
  }

  get bounds(): Bounds {
    const { height_m, radius_m } = this.model;
    const lean_m = this.model.leans ? MOST_LEAN * height_m : 0;
    const reach_m = this.exaggeration * (this.motion?.reach_m ?? 0) + lean_m;
    const bounds = { height_m, radius_m, reach_m };
    return this.instances.oriented?.upright === false ? orientedBounds(bounds) : bounds;
  }

  /** Data for picking. */
  get pickable() {
    const { instances, bounds, motion, exaggeration } = this;
    this.jointRadius_m ??= motion
      ? jointRadii(
          this.model.parts.map(({ position }) => position.array),
          motion,
        )
      : new Float32Array(0);
    return { instances, bounds, motion, exaggeration, jointRadius_m: this.jointRadius_m };
  }

  /** Selects the trees that are drawn in this view, and their level of detail. */
  select(view: View): void {
    const cardsFrom_m = this.cards?.from_m;
    const near_m = this.fallen || !this.parts.some(({ near }) => near) ? 0 : view.near_m;
    this.list.select(this.bounds, { ...view, near_m, cardsFrom_m });
    const texels = this.nodes?.place(this.list);
    if (this.nodes) this.uniforms.uNodeShift.value = this.nodes.shift;
    for (let level = 0; level < LEVEL_COUNT; level++) {
      this.levels[level].fill(this.list, this.instances.data, texels?.[level] ?? ALL_TREES);
    }
    if (texels) this.selectCards(texels);
  }

  private selectCards(texels: readonly LevelTexels[]): void {
    const { cards, nodes } = this;
    if (!cards || !nodes || !Number.isFinite(cards.from_m)) return;
    cards.show(this.list, this.instances.data, texels, nodes.target.texture, nodes.shift);
  }

  /** Triangles of the last selection in the colour pass. */
  get triangles(): number {
    return this.levels.reduce((sum, level) => sum + level.visibleTriangles, 0);
  }

  /** `easing`: of poses that are reached over several frames. */
  setPoses(poses: Float32Array, easing: Easing | null = null): void {
    if (!this.frozen) this.nodes?.setPoses(poses, easing);
  }

  /** Shows what the modes do not show of pulled trees. */
  showPulls(pulls: readonly ShownPull[]): void {
    this.pulls?.show(pulls);
  }

  renderNodes(renderer: NodeRenderer): void {
    if (!this.frozen) this.nodes?.render(renderer);
  }

  /** Draws the trees as static instances, or moving again, to measure the cost of the motion. */
  freeze(frozen: boolean): void {
    this.frozen = frozen;
    const still = new Map(
      this.parts.map((own) => {
        if (frozen) own.still ??= this.materials(own.part, false, own.firstVertex);
        return [own.moving, own.still] as const;
      }),
    );
    this.leafless = this.fallen; // also of the new materials
    for (const level of this.levels) {
      level.drawWith((moving) => (frozen && still.get(moving)) || moving);
    }
  }

  dispose(): void {
    this.group.removeFromParent();
    this.nodes?.dispose();
    this.cards?.dispose();
    this.pulls?.dispose();
    for (const level of this.levels) level.dispose();
    for (const { moving, still } of this.parts) {
      for (const materials of [moving, still]) {
        materials?.colour.dispose();
        materials?.shadow?.dispose();
        materials?.distance?.dispose();
      }
    }
  }
}
