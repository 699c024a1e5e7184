/** The tree that this visitor holds: finds it in every placement, and turns places into orders for the worker. */

import type { PulledTree, PullOrder, TreeAt } from "galewood/client";
import { INSTANCE_FLOATS } from "galewood/trees";
import { Vector3 } from "three";
import { exaggeration } from "../../scene/exaggeration";
import type { MovingGroup } from "../../scene/forest";
import type { World } from "../forest/world";
import { displacementOf, type GrabbedTree, restOf, toTree, toWorld, type Vector } from "./grabPoint";

/** A point of a tree, whatever its index in the placement. */
export interface Grip {
  readonly treeId: string;
  readonly id: number;
  readonly vertex: number;
}

/** Number of this page's hand: random, so that clients of a shared forest have different ones. */
const HAND_ID = Math.floor(Math.random() * 2 ** 48);

export class HeldTree {
  private shown: readonly MovingGroup[] = [];
  private at: TreeAt | null = null;

  constructor(
    private readonly world: World,
    readonly grip: Grip,
  ) {}

  /** Where the tree is now; null if it does not move or is gone. */
  get place(): TreeAt | null {
    if (this.shown !== this.world.forest.moving) {
      this.shown = this.world.forest.moving;
      this.at = treeAt(this.shown, this.grip);
    }
    return this.at;
  }

  private get tree(): GrabbedTree | null {
    return this.place && grabbedTree(this.world, this.place);
  }

  /** What is shown of this page's pull. */
  private get pull(): PulledTree | null {
    return this.world.client.pulled.find(({ hand, held }) => held && hand === HAND_ID) ?? null;
  }

  /** The held point in the world; null if the tree is gone. */
  get point(): Vector3 | null {
    const { tree, pull } = this;
    if (!tree) return null;
    const { vertex } = this.grip;
    const field = pull && this.world.client.pullFields.get(pull.table, vertex);
    const { all } = displacementOf(this.drawn(tree), vertex, pull && { field, force_N: pull.force_N });
    const rest = restOf(tree.parts, vertex);
    const own: Vector = [rest[0] + all[0], rest[1] + all[1], rest[2] + all[2]];
    return new Vector3(...toWorld(tree.instances, tree.tree, own));
  }

  private drawn(tree: GrabbedTree): GrabbedTree {
    return { ...tree, exaggeration: exaggeration.value };
  }

  /** Force of the hand on the tree, N. A tree of twice the size is four times as strong. */
  get force_N(): number {
    const { tree, pull } = this;
    if (!tree || !pull) return 0;
    return Math.hypot(...pull.force_N) * tree.instances.data[tree.tree * INSTANCE_FLOATS + 6] ** 2;
  }

  /** Moves the held point to a place in the world. */
  pullTo(target: Vector3): void {
    const { tree, place } = this;
    if (!tree || !place) return;
    const wanted = toTree(tree.instances, tree.tree, [target.x, target.y, target.z]);
    const rest = restOf(tree.parts, this.grip.vertex);
    const { value } = exaggeration; // the hand follows what is drawn
    const { swung } = displacementOf(this.drawn(tree), this.grip.vertex, null);
    const [x, y, z] = wanted.map((at, axis) => (at - rest[axis] - swung[axis]) / value);
    const order: PullOrder = {
      hand: HAND_ID,
      at: place,
      vertex: this.grip.vertex,
      target_m: [x, y, z],
    };
    this.world.client.pull(order);
  }

  release(): void {
    this.world.client.release(HAND_ID);
  }
}

/** The index of a tree among those that move. */
export function treeAt(moving: readonly MovingGroup[], { treeId, id }: Omit<Grip, "vertex">): TreeAt | null {
  const group = moving.findIndex(({ asset }) => asset.id === treeId);
  const tree = group < 0 ? -1 : moving[group].forest.instances.ids.indexOf(id);
  return tree < 0 ? null : { group, tree };
}

/** A tree with its mesh in its newest pose; null while it does not move. */
export function grabbedTree({ forest, client }: World, at: TreeAt): GrabbedTree | null {
  const species = forest.moving[at.group]?.forest;
  if (!species?.motion) return null;
  const { model, motion, instances } = species;
  const poses = client.poses[at.group] ?? null;
  return {
    parts: model.parts,
    motion,
    instances,
    poses,
    tree: at.tree,
    leafless: species.leafless,
    exaggeration: exaggeration.value,
  };
}
