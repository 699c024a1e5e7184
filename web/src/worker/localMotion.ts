/** Every tree looked up here. */
import { ForestLookup } from "../lookup";
import { poseStride } from "../nodeLayout";
import type { Method } from "../settings";
import type { Table } from "../table";
import { TangentForest } from "../tangent";
import { sampledPeak, type WindField } from "../wind";
import { coverageOf, GroupWind } from "./groupWind";
import type { MotionSource } from "./motion";
import type { Connection } from "./protocol";

/** Wind and poses move in the table's own steps at most, so that a slow display sees the same motion. */
const MAX_STEP_S = 1 / 30;

export interface LocalGroup {
  readonly table: Table;
  readonly placement: Float32Array;
}

export class LocalMotion implements MotionSource {
  readonly connection: Connection = { state: "idle", latency_ms: null, frameAge_ms: null, kB_s: 0 };
  private readonly groups: { lookup: ForestLookup | TangentForest; wind: GroupWind; modes: number }[];

  constructor(
    groups: readonly LocalGroup[],
    private readonly field: WindField,
    { method, poseEasing }: { method: Method; poseEasing: number | null },
    public time_s: number,
  ) {
    this.groups = groups.map(({ table, placement }) => {
      const count = placement.length / 4;
      const options = poseEasing === null ? {} : { poseEasing };
      const lookup =
        method === "tangent" ? new TangentForest(table, count) : new ForestLookup(table, count, options);
      const own = new GroupWind(placement, table.metadata.height_m, sampledPeak(table.pressure));
      lookup.setTrees(own.x, own.z, own.column(2), own.column(3));
      return { lookup, wind: own, modes: table.metadata.modes };
    });
  }

  windChanged(): void {}

  get coverage(): number {
    return coverageOf(this.groups.map(({ wind }) => wind));
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    const steps = Math.max(1, Math.ceil(dt_s / MAX_STEP_S - 1e-9));
    for (let step = 0; step < steps; step++) this.step(dt_s / steps);
    for (let g = 0; g < this.groups.length; g++) this.write(g, out[g]);
    return true;
  }

  private step(dt_s: number): void {
    this.time_s += dt_s;
    for (const { lookup, wind } of this.groups) {
      wind.blow(this.field, this.time_s);
      lookup.advance(dt_s, wind.pressureX, wind.pressureZ);
    }
  }

  private write(group: number, out: Float32Array): void {
    const { lookup, wind, modes } = this.groups[group];
    const stride = poseStride(modes);
    for (let tree = 0; tree < lookup.count; tree++) {
      for (let k = 0; k < modes; k++) out[tree * stride + k] = lookup.q[tree * modes + k];
    }
    wind.writeSpeeds(out, modes);
  }

  dispose(): void {}
}
