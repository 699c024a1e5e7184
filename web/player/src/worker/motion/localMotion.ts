/** Poses computed from the tables in this worker. */

import { CoarseForest } from "../../core/modal/coarseForest";
import { ModalForest } from "../../core/modal/modalForest";
import { PlaceGusts } from "../../core/modal/placeGusts";
import { coverageOf, extrapolationRatioOf, GroupWind } from "../../core/motion/groupWind";
import { JointWind } from "../../core/motion/jointWind";
import { type Changed, LeveledTrees, middleOf_s, NO_TREES } from "../../core/motion/leveledTrees";
import { LeveledWind } from "../../core/motion/leveledWind";
import type { Method } from "../../core/motion/method";
import { PaperForest } from "../../core/motion/paperSearch";
import { poseStride } from "../../core/motion/poseStride";
import { FAR_LEVELS, FramePace, type Viewer } from "../../core/motion/simulationLevels";
import { SteppedTrees, stepsOf } from "../../core/motion/steppedTrees";
import type { Records } from "../../core/table/records";
import type { Table } from "../../core/table/table";
import type { WindField } from "../../core/wind/field";
import { withFront } from "../../core/wind/transition";
import type { Connection, Inspection, PullOrder, TreeAt } from "../protocol";
import { rowsBefore, type ShownGroup } from "./carry";
import type { MotionSource } from "./motionSource";
import { HeldTrees } from "./pulls/heldTrees";
import { PointResponses } from "./pulls/pointResponses";
import type { Pulled } from "./pulls/pulled";
import type { StartOfGroup } from "./shownPoses";

export interface LocalGroup extends ShownGroup {
  readonly table: Table;
  readonly sha256: string;
  /** Records of the table; without them its trees use the modal method. */
  readonly records: Records | null;
  readonly placement: Float32Array;
  /** Index of each tree among those of all workers, if others have the rest. */
  readonly rows?: Uint32Array | null;
  /** Address of its compliance file. */
  readonly compliance: string | null;
}

/** Trees whose ranges are summed up per frame. */
const SUMMED_TREES = 10_000;

function largest(ratios: Float32Array): number {
  let most = 0;
  for (let tree = 0; tree < ratios.length; tree++) if (ratios[tree] > most) most = ratios[tree];
  return most;
}

interface Moving {
  readonly group: LocalGroup;
  readonly trees: SteppedTrees<PaperForest | ModalForest>;
}

/** The trees of a group; those of the modal method have simulation levels. `poseEasing`: of the paper's method. */
function treesOf(
  { table, records, placement, rows = null }: LocalGroup,
  method: Method,
  poseEasing: number | null,
): SteppedTrees<PaperForest | ModalForest> {
  const { height_m, peak_pressure_pa, modes, streamlined_exponent } = table.metadata;
  const count = placement.length / 4;
  if (method === "paper" && records) {
    const lookup = new PaperForest(table, records, count, poseEasing === null ? {} : { poseEasing });
    const wind = new GroupWind(placement, height_m, peak_pressure_pa, streamlined_exponent, true);
    return new SteppedTrees(lookup, null, wind, modes);
  }
  const lookup = new CoarseForest(
    table,
    count,
    FAR_LEVELS.map(({ steps }) => steps),
  );
  const wind = new LeveledWind(placement, height_m, table.modal.limits[2], streamlined_exponent);
  const gusts = new PlaceGusts(table.modal, count);
  // Without the kernel there are no coarse models.
  return lookup.compiled
    ? new LeveledTrees(lookup, gusts, wind, modes, rows)
    : new SteppedTrees(lookup, gusts, wind, modes);
}

export class LocalMotion implements MotionSource {
  readonly connection: Connection = { state: "idle", latency_ms: null, frameAge_ms: null, kB_s: 0 };
  private readonly groups: Moving[];
  private readonly wind: JointWind;
  private wind_ms = 0;
  private watched: TreeAt | null = null;
  private kept = "";
  private pace = new FramePace();
  private reached = { coverage: 1, extrapolationRatio: 0 };
  changed: readonly (Changed | null)[] = [];
  readonly hands: HeldTrees;

  constructor(
    groups: readonly LocalGroup[],
    private readonly field: WindField,
    { method, poseEasing }: { method: Method; poseEasing: number | null },
    public time_s: number,
    responses: PointResponses = new PointResponses(),
  ) {
    this.hands = new HeldTrees(this, responses);
    this.groups = groups.map((group) => ({ group, trees: treesOf(group, method, poseEasing) }));
    this.wind = new JointWind(this.groups.map(({ trees }) => trees.wind));
  }

  /** Starts the trees of the modal method where and as fast as they are displayed; `adopt` has precedence. */
  startAt(starts: readonly (StartOfGroup | null)[]): void {
    this.wind.update(this.field, this.field.at(this.time_s));
    for (const [g, { trees }] of this.groups.entries()) {
      const { lookup, wind, modes } = trees;
      const start = starts[g];
      if (!start || !(lookup instanceof ModalForest)) continue;
      const stride = poseStride(modes);
      for (let tree = 0; tree < lookup.count; tree++) {
        if (start.known[tree] === 0) continue;
        const pose = start.poses.subarray(tree * stride, tree * stride + modes);
        const rate = start.rates.subarray(tree * stride, tree * stride + modes);
        lookup.startAt(tree, pose, rate, wind.pressureX[tree], wind.pressureZ[tree]);
      }
    }
  }

  /** Takes over the state of trees that existed before with the same table and method. */
  adopt(before: LocalMotion): void {
    this.pace = before.pace;
    for (const { group, trees } of this.groups) {
      const { lookup } = trees;
      const old = before.groups.find(
        (other) => other.group.key === group.key && other.group.table === group.table,
      );
      if (!old) continue;
      const rows = rowsBefore(old.group.ids, group.ids);
      if (lookup instanceof ModalForest && old.trees.lookup instanceof ModalForest) {
        lookup.adopt(old.trees.lookup, rows);
        if (trees instanceof LeveledTrees && old.trees instanceof LeveledTrees)
          trees.levels.adopt(old.trees.levels, rows);
      } else if (lookup instanceof PaperForest && old.trees.lookup instanceof PaperForest) {
        lookup.adopt(old.trees.lookup, rows);
      }
    }
  }

  tableOf(group: number): LocalGroup | null {
    return this.groups[group]?.group ?? null;
  }

  displace({ group, tree }: TreeAt, e: Float64Array, v: Float64Array): boolean {
    const lookup = this.groups[group]?.trees.lookup;
    if (!(lookup instanceof ModalForest) || tree >= lookup.count) return false;
    lookup.displace(tree, e, v);
    return true;
  }

  pull(order: PullOrder): void {
    if (order.at.tree < (this.groups[order.at.group]?.trees.lookup.count ?? 0)) this.hands.pull(order);
  }

  release(hand: number): void {
    this.hands.release(hand);
  }

  get pulled(): Pulled[] {
    return this.hands.pulled;
  }

  gust(x_m: number, z_m: number): void {
    this.field.state = withFront(this.field.state, x_m, z_m, this.time_s);
  }

  get coverage(): number {
    return this.reached.coverage;
  }

  get extrapolationRatio(): number {
    return this.reached.extrapolationRatio;
  }

  /** Sums up how far winds and trees are within the sampled range; of large forests not in every frame. */
  private sumUp(dt_s: number): void {
    const count = this.groups.reduce((sum, { trees: { lookup } }) => sum + lookup.count, 0);
    if (dt_s > 0 && this.pace.frame % Math.ceil(count / SUMMED_TREES) > 0) return;
    for (const { trees } of this.groups) if (trees instanceof LeveledTrees) trees.wind.sumUp();
    const winds = this.groups.map(({ trees }) => trees.wind);
    const reached = this.groups.map(({ trees: { lookup } }) =>
      lookup instanceof ModalForest ? largest(lookup.extrapolationRatio) : 0,
    );
    this.reached = {
      coverage: coverageOf(winds),
      extrapolationRatio: Math.max(extrapolationRatioOf(winds), ...reached),
    };
  }

  /** Trees far from the viewer or out of view move with less detail. */
  see(viewer: Viewer): void {
    for (const { trees } of this.groups) trees.see(viewer);
  }

  watch(at: TreeAt | null): void {
    this.watched = at;
  }

  takeWind_ms(): number {
    const { wind_ms } = this;
    this.wind_ms = 0;
    return wind_ms;
  }

  inspect({ group, tree }: TreeAt): Inspection | null {
    const found = this.groups[group]?.trees;
    if (!found || tree >= found.lookup.count) return null;
    const { lookup, wind } = found;
    const felt = wind.extrapolationRatioAt(tree);
    if (lookup instanceof PaperForest) return { extrapolationRatio: felt, record: lookup.record[tree] };
    return { extrapolationRatio: Math.max(felt, lookup.extrapolationRatio[tree]), record: null };
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    const { steps, step_s } = stepsOf(dt_s);
    const begin_s = this.time_s;
    this.keepNear();
    if (dt_s > 0) this.pace.next(dt_s);
    this.changed = this.groups.map(({ trees }) =>
      trees instanceof LeveledTrees ? trees.begin(begin_s, dt_s, this.pace) : null,
    );
    for (let step = 0; step < steps; step++) this.step(step_s);
    if (dt_s > 0) this.stepFar(begin_s, out);
    for (const [g, { trees }] of this.groups.entries()) trees.write(out[g]);
    this.sumUp(dt_s);
    this.hands.follow(dt_s, out);
    return true;
  }

  /** Steps distant trees, level by level, because the wind of a level is that of one moment for all groups. */
  private stepFar(begin_s: number, out: readonly Float32Array[]): void {
    const { field, pace, groups, wind } = this;
    for (let level = 0; level < FAR_LEVELS.length; level++) {
      const begin_ms = performance.now();
      const moment = field.at(begin_s + middleOf_s(level, pace));
      const turns = groups.map(({ trees }) =>
        trees instanceof LeveledTrees ? trees.turnsOf(level) : NO_TREES,
      );
      wind.update(field, moment, turns);
      this.wind_ms += performance.now() - begin_ms;
      const usual_s = pace.periodOf(level) * pace.frame_s;
      for (const [g, { trees }] of groups.entries())
        if (trees instanceof LeveledTrees) trees.stepFar(level, begin_s + usual_s, usual_s, out[g]);
    }
  }

  /** Trees in a hand, and the one whose figures are shown, are stepped fully. */
  private keepNear(): void {
    const wanted = [...this.hands.places, ...(this.watched ? [this.watched] : [])];
    const key = wanted.map(({ group, tree }) => `${group} ${tree}`).join();
    if (key === this.kept) return;
    this.kept = key;
    for (const [g, { trees }] of this.groups.entries())
      if (trees instanceof LeveledTrees)
        trees.levels.keepNear(wanted.filter(({ group }) => group === g).map(({ tree }) => tree));
  }

  private step(dt_s: number): void {
    this.time_s += dt_s;
    const begin_ms = performance.now();
    const moment = this.field.at(this.time_s);
    const stepped = this.groups.map(({ trees }) => trees.stepped);
    this.wind.update(this.field, moment, stepped);
    this.wind_ms += performance.now() - begin_ms;
    for (const { trees } of this.groups) trees.step(dt_s, moment);
  }

  dispose(): void {}
}
