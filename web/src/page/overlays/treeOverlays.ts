/** Draws skeleton, tetrahedra, modes, wind, strain or error on the picked tree, moving with it. */

import type { TableMotion } from "galewood/client";
import { NodePose } from "galewood/motion";
import { INSTANCE_FLOATS, leanAt, type UprightTrees } from "galewood/trees";
import { Group } from "three";
import { exaggeration } from "../../scene/exaggeration";
import type { Frame } from "../forest/frameLoop";
import type { World } from "../forest/world";
import type { TreePicker } from "../picking/treePicker";
import { Problem } from "../server/api";
import type { Catalogue } from "../server/catalogue";
import { whole } from "../ui/words";
import {
  type Drawing,
  errorDrawing,
  modeDrawing,
  skeletonDrawing,
  strainDrawing,
  tetrahedraDrawing,
  windDrawing,
} from "./drawings";
import { modesByFrequency, modeWords } from "./modes";
import { type OverlayKind, OverlayMenu } from "./overlayMenu";
import { structureOf } from "./structure";
import { strainOf } from "./treeStrain";

const millimetres = (error_m: Float32Array) => Math.max(...error_m) * 1000;

export class TreeOverlays {
  readonly menu = new OverlayMenu({
    chosen: (kind) => this.choose(kind),
    mode: (step) => {
      this.mode += step;
    },
  });
  private readonly frame = Object.assign(new Group(), { matrixAutoUpdate: false });
  private kind: OverlayKind = "none";
  private mode = 0;
  private drawing: Drawing | null = null;
  private pose: NodePose | null = null;
  /** What the drawing shows; another key needs another drawing. */
  private key = "";
  private note = "";

  /** `errors`: of each node of a table, m, from the last comparison, by the hash of the table. */
  constructor(
    private readonly world: World,
    private readonly catalogue: Catalogue,
    private readonly picker: TreePicker,
    private readonly errors: ReadonlyMap<string, Float32Array>,
  ) {
    world.stage.scene.add(this.frame);
  }

  private choose(kind: OverlayKind): void {
    this.kind = kind;
    this.menu.show(kind, "");
  }

  /** What is drawn now: the kind, once its data have arrived. */
  get shown(): OverlayKind {
    return this.drawing ? this.kind : "none";
  }

  /** Makes the drawing that was chosen, and moves it with the tree. */
  advance({ played_s }: Frame): void {
    const { selected } = this.picker;
    const at = this.kind === "none" ? null : this.picker.moving;
    const { forest, client } = this.world;
    const group = at ? forest.moving[at.group]?.forest : undefined;
    const poses = at ? client.poses[at.group] : undefined;
    if (!selected || !at || !group?.motion || !poses) {
      this.clear();
      return;
    }
    const { motion, instances } = group;
    const { tree } = at;
    this.stand(instances, tree);
    this.prepare(selected.treeId, motion);
    if (!this.drawing || !this.pose) return;
    const { moved, jointMoved } = this.pose.take(poses, tree * motion.stride, exaggeration.value);
    this.drawing.update({ moved, jointMoved, time_s: client.time_s, step_s: played_s });
  }

  /** Places the drawing where and as the tree stands. */
  private stand(instances: UprightTrees, tree: number): void {
    const [x, y, z, , cosine, sine, scale] = instances.data.subarray(tree * INSTANCE_FLOATS);
    this.frame.position.set(x, y, z);
    this.frame.rotation.y = Math.atan2(sine, cosine);
    this.frame.scale.setScalar(scale);
    this.frame.updateMatrix();
    const [leanX, leanZ] = leanAt(instances, tree);
    this.frame.matrix.elements[4] = leanX * scale; // the column of the tree's vertical
    this.frame.matrix.elements[6] = leanZ * scale;
    this.frame.matrixWorldNeedsUpdate = true;
  }

  /** Where the wind blows now, in the frame of the tree. */
  private get heading_deg(): number {
    const { direction_deg } = this.world.field.at(this.world.client.time_s).wind;
    return (direction_deg + (this.frame.rotation.y * 180) / Math.PI) % 360;
  }

  private prepare(treeId: string, motion: TableMotion): void {
    const order = modesByFrequency(motion);
    const at = ((this.mode % order.length) + order.length) % order.length;
    const error_m = this.kind === "error" ? (this.errors.get(motion.sha256) ?? null) : null;
    const key = [treeId, motion.sha256, this.kind, this.kind === "modes" && at, error_m !== null].join(" ");
    if (key === this.key) return;
    this.clear();
    this.key = key;
    this.pose = new NodePose(motion);
    this.make(treeId, motion, order[at], error_m).catch((problem: unknown) => {
      if (this.key !== key) return;
      this.say(problem instanceof Problem ? `${problem.title}. ${problem.hint}` : String(problem));
    });
  }

  private async make(
    treeId: string,
    motion: TableMotion,
    mode: number,
    error_m: Float32Array | null,
  ): Promise<void> {
    const { kind, key } = this;
    if (kind === "wind") {
      this.use(windDrawing(this.world.field, motion, this.frame), "");
      return;
    }
    if (kind === "error") {
      if (error_m) this.use(errorDrawing(error_m, motion), errorWords(error_m));
      else
        this.say("“Check accuracy” compares this tree with finite elements. Its error is shown afterwards.");
      return;
    }
    const known = this.catalogue.find(treeId);
    if (!known) return;
    if (kind === "strain") {
      this.say("Calculating the strain …");
      const bearing = await strainOf(treeId, this.catalogue.foliage, this.heading_deg, this.frame.scale.y);
      if (this.key === key) this.use(strainDrawing(bearing, motion), bearing.words);
      return;
    }
    this.say("Loading …");
    const structure = await structureOf(known.tree);
    if (this.key !== key) return;
    if (kind === "skeleton")
      this.use(skeletonDrawing(structure, motion), `${structure.points_m.length / 3} points`);
    else if (kind === "tetrahedra")
      this.use(tetrahedraDrawing(structure, motion), `${whole(structure.tets)} tetrahedra`);
    else this.use(modeDrawing(structure, motion, mode), modeWords(motion, mode));
  }

  private use(drawing: Drawing, note: string): void {
    this.drawing = drawing;
    // Arrows are placed in the world, the rest in the tree's frame.
    (this.kind === "wind" ? this.world.stage.scene : this.frame).add(drawing.object);
    this.say(note);
  }

  private say(note: string): void {
    this.note = note;
    this.menu.show(this.kind, note);
  }

  private clear(): void {
    this.key = "";
    this.drawing?.object.removeFromParent();
    this.drawing?.dispose();
    this.drawing = null;
    if (this.note !== "") this.say("");
  }
}

function errorWords(error_m: Float32Array): string {
  return `White: none, red: ${millimetres(error_m).toFixed(0)} mm (root mean square against finite elements).`;
}
