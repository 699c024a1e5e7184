/** What the worker does: reads tables and steps groups of trees. Knows no worker, so that tests can call it. */

import { GivenWind } from "../../core/forest/givenWind";
import { advance, movedTo, type Trees, treesOf } from "../../core/forest/trees";
import { JointWind } from "../../core/motion/jointWind";
import type { Viewer } from "../../core/motion/simulationLevels";
import { drawnMotion } from "../../core/table/drawnMotion";
import type { DrawnMotion } from "../../core/table/drawnTable";
import { decodeWithoutRecords, type Table } from "../../core/table/table";
import type { WindDocument } from "../../core/wind/document";
import { WindField } from "../../core/wind/field";
import type { Floats, GroupFrame } from "./messages";

interface Group {
  readonly table: Table;
  trees: Trees;
}

export class Stepper {
  time_s = 0;
  private readonly tables = new Map<number, Table>();
  private readonly groups = new Map<number, Group>();
  private field: WindField | null = null;
  /** The wind at the trees of all groups; null if these have changed. */
  private joint: JointWind | null = null;
  /** Given velocities at the trees of a group. */
  private readonly velocities = new Map<number, Floats>();

  read(table: number, bytes: ArrayBuffer): DrawnMotion {
    const decoded = decodeWithoutRecords(bytes);
    this.tables.set(table, decoded);
    return drawnMotion(decoded);
  }

  plant(group: number, table: number, placement: Floats): void {
    const decoded = this.tables.get(table);
    if (!decoded) throw new Error(`table ${table} is used before it was loaded`);
    const before = this.groups.get(group)?.trees;
    const trees = before ? movedTo(before, decoded, placement) : treesOf(decoded, placement);
    this.groups.set(group, { table: decoded, trees });
    this.joint = null;
  }

  remove(group: number): void {
    this.groups.delete(group);
    this.joint = null;
  }

  /** null: velocities come with every frame. */
  setWind(wind: WindDocument | null): void {
    if (wind === null) this.field = new GivenWind((_x, _z, _time_s, outX, outZ) => this.take(outX, outZ));
    else if (this.field && !(this.field instanceof GivenWind)) this.field.change(wind, this.time_s);
    else this.field = new WindField(wind);
  }

  private take(outX: { [index: number]: number }, outZ: typeof outX): void {
    let at = 0;
    for (const [group, { trees }] of this.groups) {
      const velocity = this.velocities.get(group);
      for (let i = 0; i < trees.wind.count; i++, at++) {
        outX[at] = velocity ? velocity[2 * i] : 0;
        outZ[at] = velocity ? velocity[2 * i + 1] : 0;
      }
    }
  }

  advance(dt_s: number, viewer: Viewer, frames: readonly GroupFrame[]): void {
    if (!this.field) return;
    this.velocities.clear();
    for (const { group, velocity } of frames) {
      const trees = this.groups.get(group)?.trees;
      trees?.see(viewer);
      if (trees && velocity) this.velocities.set(group, velocity);
    }
    const all = Array.from(this.groups.values(), (group) => group.trees);
    this.joint ??= new JointWind(all.map(({ wind }) => wind));
    this.time_s = advance(all, this.joint, this.field, this.time_s, dt_s);
    for (const { group, poses } of frames) this.groups.get(group)?.trees.write(poses);
  }
}
