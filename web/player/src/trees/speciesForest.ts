/** All trees of one species: pass 1 for its nodes, instanced meshes at every level of detail for pass 2. */
import { Group } from "three";
import type { Easing } from "../core/motion/easedPoses";
import type { DrawnMotion } from "../core/table/drawnTable";
import type { CloseLeaves } from "./culling/closeLeaves";
import { type Bounds, orientedBounds } from "./culling/culling";
import { DrawList, type View } from "./drawList";
import {
  ADDED_PART,
  type DrawnPart,
  type PlannedPart,
  type ShadowOptions,
  type Together,
  type TreeMeshes,
} from "./drawnParts";
import type { FarCards } from "./farCards";
import type { InstanceData } from "./instanceData";
import { USUAL_HZ } from "./leafFlutter";
import { MOST_LEAN } from "./lean";
import { ApartMeshes } from "./levelMeshes";
import type { AddedPart, TreeModel, TreePart } from "./mesh/treeMesh";
import type { NodeRenderer, TreeGraphics } from "./nodes/nodeGraphics";
import { NodePass } from "./nodes/nodePass";
import type { LevelTexels, TreeNodes } from "./nodes/treeNodes";
import type { MaterialMaker, PartMaterials } from "./partMaterials";
import type { PullSlots, ShownPull } from "./pull/pullSlots";
import { jointRadii } from "./treePick";
import type { SpeciesUniforms } from "./treeShader";

export interface SpeciesOptions {
  readonly materials: MaterialMaker;
  /** What depends on the renderer. */
  readonly graphics: TreeGraphics;
  readonly maxTextureSide: number;
  readonly shadows: ShadowOptions;
  /** Draws near parts, and fine shoots in place of fallen leaves; without smoothed edges they would be specks. */
  readonly fine: boolean;
  /** Draws all levels of detail of a part with one call, if the renderer can; otherwise each is drawn apart. */
  together?(): Together;
  /** What draws leaves one by one close to the eye; without it they are cards and near parts. */
  closeLeaves?(model: TreeModel, motion: DrawnMotion, uniforms: SpeciesUniforms, group: Group): CloseLeaves;
  /** What shows pulled branches, by the vertex whose motion each vertex takes; without it they are not shown. */
  pullsOf?(holds: Uint32Array): PullSlots;
  /** Shared clock and amplitude of the flutter of leaves. */
  readonly flutter: { value: { x: number; y: number } };
  /** Shared factor of all displacements on screen. */
  readonly exaggeration: { value: number };
}

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

interface OwnPart extends PlannedPart {
  readonly moving: PartMaterials | null;
  /** Materials without any deformation, created on first use. */
  still: PartMaterials | null;
}

/** `Motion`: what is known of the motion besides what drawing needs. */
export class SpeciesForest<Motion extends DrawnMotion = DrawnMotion> {
  readonly group = new Group();
  private readonly nodes: TreeNodes | null;
  private readonly pulls: PullSlots | null;
  private readonly uniforms: SpeciesUniforms;
  private readonly parts: OwnPart[];
  private readonly meshes: TreeMeshes;
  private list: DrawList;
  private frozen = false;
  private fallen = false;
  private jointRadius_m: Float32Array | null = null;
  /** Impostors of distant trees, if the scene has any. */
  cards: FarCards | null = null;
  private readonly close: CloseLeaves | null;

  /** Without `motion` the trees stand still. */
  constructor(
    readonly model: TreeModel,
    readonly motion: Motion | null,
    public instances: InstanceData,
    readonly options: SpeciesOptions,
  ) {
    const { graphics, maxTextureSide, exaggeration, shadows } = options;
    this.pulls = options.pullsOf?.(holdsOf(model)) ?? null;
    const together = options.together?.();
    this.nodes =
      motion && (together?.nodes(motion) ?? new NodePass(motion, graphics, maxTextureSide, exaggeration));
    this.uniforms = {
      ...this.pulls?.uniforms,
      uNodes: { value: this.nodes?.target.texture ?? null },
      uNodeShift: this.nodes?.shift ?? { value: 0 },
      uLean: { value: model.leans ? 1 : 0 },
      uFlutter: options.flutter,
      uLeafHz: { value: model.flutter_hz ?? USUAL_HZ },
      uExaggeration: options.exaggeration,
      uClose: { value: { x: 0, y: 0, z: 0, w: 0 } },
      together: together?.uniforms,
    };
    const planned = this.planParts();
    this.parts = (together?.merged(planned) ?? planned).map((part) => this.ownPart(part));
    const drawn = this.parts.flatMap((part): DrawnPart[] => {
      const materials = part.moving ?? part.still;
      return materials ? [{ ...part, materials }] : [];
    });
    this.meshes =
      together?.meshes(drawn, motion, shadows, this.group) ??
      new ApartMeshes(drawn, motion, shadows, this.group, graphics.adapt);
    this.close = (motion && options.closeLeaves?.(model, motion, this.uniforms, this.group)) ?? null;
    this.list = new DrawList(instances);
  }

  private planParts(): PlannedPart[] {
    const { parts: read, added } = this.model;
    let firstVertex = 0;
    const plan = (part: TreePart, first: number, pullFirst: number): PlannedPart => {
      const season = part.kind === "leaves" ? "leafy" : "always";
      return { part, firstVertex: first, pullFirst, season, near: false };
    };
    const parts = read.map((part) => {
      const planned = plan(part, firstVertex, firstVertex);
      firstVertex += part.vertices;
      return planned;
    });
    const held = ({ part, of }: AddedPart) => plan(part, parts[of].firstVertex, ADDED_PART);
    const always = [...parts, ...added.map(held)];
    if (!this.options.fine) return always;
    const { bare, near } = this.model; // made now
    const inLeaf = near.map((one): PlannedPart => ({ ...held(one), season: "leafy", near: true }));
    return [...always, ...inLeaf, ...bare.map((one): PlannedPart => ({ ...held(one), season: "bare" }))];
  }

  private ownPart(planned: PlannedPart): OwnPart {
    return {
      ...planned,
      moving: this.motion ? this.materials(planned, true) : null,
      still: this.motion ? null : this.materials(planned, false),
    };
  }

  private materials({ part, pullFirst }: PlannedPart, moves: boolean): PartMaterials {
    const uniforms = { ...this.uniforms, uPullFirst: { value: pullFirst } };
    const materials = this.options.materials(part.material, part.kind, uniforms, moves);
    materials.colour.vertexColors = part.colour !== null;
    return materials;
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
    // It is called again when texels move: with the trees of this selection.
    const { nodes, list } = this;
    const { data } = this.instances;
    const fill = (texels: readonly LevelTexels[] | null) => {
      this.meshes.fill(list, data, texels);
      if (!nodes || !texels) return;
      this.cards?.show(list, data, texels, nodes.target.texture, nodes.shift.value);
      this.close?.show(list, data, texels, view);
    };
    if (nodes) nodes.place(list, fill);
    else fill(null);
  }

  /** Triangles of the last selection in the colour pass. */
  get triangles(): number {
    return this.meshes.visibleTriangles + (this.close?.triangles ?? 0);
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
        if (frozen) own.still ??= this.materials(own, false);
        return [own.moving, own.still] as const;
      }),
    );
    this.leafless = this.fallen; // also of the new materials
    this.meshes.drawWith((moving) => (frozen && still.get(moving)) || moving);
  }

  dispose(): void {
    this.group.removeFromParent();
    this.nodes?.dispose();
    this.cards?.dispose();
    this.close?.dispose();
    this.pulls?.dispose();
    this.meshes.dispose();
    for (const { moving, still } of this.parts) {
      for (const materials of [moving, still]) {
        materials?.colour.dispose();
        materials?.shadow?.dispose();
        materials?.distance?.dispose();
      }
    }
  }
}
