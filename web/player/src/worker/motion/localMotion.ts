/** Poses computed from the tables in this worker. */

import { ModalForest } from "../../core/modal/modalForest";
import { PlaceGusts } from "../../core/modal/placeGusts";
import { coverageOf, extrapolationRatioOf, GroupWind } from "../../core/motion/groupWind";
import type { Method } from "../../core/motion/method";
import { PaperForest } from "../../core/motion/paperSearch";
import { poseStride } from "../../core/motion/poseStride";
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
  /** Address of its compliance file. */
  readonly compliance: string | null;
}

interface Moving {
  readonly group: LocalGroup;
  readonly trees: SteppedTrees<PaperForest | ModalForest>;
}

export class LocalMotion implements MotionSource {
  readonly connection: Connection = { state: "idle", latency_ms: null, frameAge_ms: null, kB_s: 0 };
  private readonly groups: Moving[];
  private wind_ms = 0;
  readonly hands: HeldTrees;

  constructor(
    groups: readonly LocalGroup[],
    private readonly field: WindField,
    { method, poseEasing }: { method: Method; poseEasing: number | null },
    public time_s: number,
    responses: PointResponses = new PointResponses(),
  ) {
    this.hands = new HeldTrees(this, responses);
    this.groups = groups.map((group) => {
      const { table, records, placement } = group;
      const { height_m, peak_pressure_pa, modes, streamlined_exponent } = table.metadata;
      const count = placement.length / 4;
      const options = poseEasing === null ? {} : { poseEasing };
      const lookup =
        method === "paper" && records
          ? new PaperForest(table, records, count, options)
          : new ModalForest(table, count);
      const modal = lookup instanceof ModalForest;
      const peak_pa = modal ? table.modal.limits[2] : peak_pressure_pa;
      const wind = new GroupWind(placement, height_m, peak_pa, streamlined_exponent, !modal);
      const gusts = modal ? new PlaceGusts(table.modal, count) : null;
      return { group, trees: new SteppedTrees(lookup, gusts, wind, modes) };
    });
  }

  /** Starts the trees of the modal method where and as fast as they are displayed; `adopt` has precedence. */
  startAt(starts: readonly (StartOfGroup | null)[]): void {
    const moment = this.field.at(this.time_s);
    for (const [g, { trees }] of this.groups.entries()) {
      const { lookup, wind, modes } = trees;
      const start = starts[g];
      if (!start || !(lookup instanceof ModalForest)) continue;
      wind.update(this.field, moment);
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
    for (const { group, trees } of this.groups) {
      const { lookup } = trees;
      const old = before.groups.find(
        (other) => other.group.key === group.key && other.group.table === group.table,
      );
      if (!old) continue;
      const rows = rowsBefore(old.group.ids, group.ids);
      if (lookup instanceof ModalForest && old.trees.lookup instanceof ModalForest) {
        lookup.adopt(old.trees.lookup, rows);
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
    return coverageOf(this.groups.map(({ trees }) => trees.wind));
  }

  get extrapolationRatio(): number {
    const winds = extrapolationRatioOf(this.groups.map(({ trees }) => trees.wind));
    return this.groups.reduce((most, { trees: { lookup } }) => {
      if (lookup instanceof ModalForest)
        for (const one of lookup.extrapolationRatio) most = Math.max(most, one);
      return most;
    }, winds);
  }

  /** Trees far from the viewer (m, world) do without the gusts within their crowns. */
  see(x: number, z: number): void {
    for (const { trees } of this.groups) trees.see(x, z);
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
    for (let step = 0; step < steps; step++) this.step(step_s);
    for (const [g, { trees }] of this.groups.entries()) trees.write(out[g]);
    this.hands.follow(dt_s, out);
    return true;
  }

  private step(dt_s: number): void {
    this.time_s += dt_s;
    const begin_ms = performance.now();
    const moment = this.field.at(this.time_s);
    for (const { trees } of this.groups) trees.updateWind(this.field, moment);
    this.wind_ms += performance.now() - begin_ms;
    for (const { trees } of this.groups) trees.step(dt_s, moment);
  }

  dispose(): void {}
}
