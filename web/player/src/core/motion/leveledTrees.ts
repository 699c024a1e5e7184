/** The trees of one table, of which distant ones are stepped less often and by coarse models. */
import type { CoarseForest } from "../modal/coarseForest";
import type { PlaceGusts } from "../modal/placeGusts";
import type { Moment } from "../wind/transition";
import type { Chosen } from "./groupWind";
import type { LeveledWind } from "./leveledWind";
import { poseStride } from "./poseStride";
import { FAR_LEVELS, type FramePace, SimulationLevels, type Turn, type Viewer } from "./simulationLevels";
import { SteppedTrees } from "./steppedTrees";

/** Duration of a table step, s, by which the wind of a coarse step is taken at its middle. */
const TABLE_STEP_S = 1 / 30;
export const NO_TREES = new Uint32Array(0);

/** The trees whose poses one frame has changed. */
export interface Changed extends Turn {
  /** Those of distant trees that are displayed; the others keep their values. */
  readonly coordinates: Uint16Array;
}

/** How long after the begin of a frame (s) the wind of its distant trees of a level is taken: in the middle of their step. */
export const middleOf_s = (level: number, pace: FramePace): number =>
  0.5 * (pace.periodOf(level) * pace.frame_s + (FAR_LEVELS[level].steps - 1) * TABLE_STEP_S);

export class LeveledTrees extends SteppedTrees<CoarseForest> {
  readonly levels: SimulationLevels;
  /** The trees of the present frame; null: all. */
  changed: Changed | null = null;

  /** `rows`: of SimulationLevels. */
  constructor(
    lookup: CoarseForest,
    gusts: PlaceGusts,
    override readonly wind: LeveledWind,
    modes: number,
    rows: Uint32Array | null,
  ) {
    super(lookup, gusts, wind, modes);
    this.levels = new SimulationLevels(wind.x, wind.z, (tree) => lookup.leaveOut(tree), rows);
  }

  /** Distant trees are also stepped less often. */
  override see(viewer: Viewer): void {
    this.levels.see(viewer);
    const { changed } = this;
    if (changed) for (let k = 0; k < changed.near.length; k++) this.seeOne(changed.near[k], viewer);
    else super.see(viewer);
  }

  /** Begins a frame at a time (s) that lasts dt_s; returns the trees that it steps, null for all. */
  begin(time_s: number, dt_s: number, pace: FramePace): Changed | null {
    // The first frame lasts no time and shows all trees. In later ones that do not, distant trees stay as they are.
    if (dt_s > 0) this.changed = { ...this.levels.begin(time_s, pace), coordinates: this.lookup.coordinates };
    else if (this.changed) this.changed = { ...this.changed, far: [], periods: [] };
    return this.changed;
  }

  override get stepped(): Chosen {
    return this.changed?.near ?? null;
  }

  override step(dt_s: number, moment: Moment): void {
    const { lookup, gusts, wind, changed } = this;
    if (!changed) {
      super.step(dt_s, moment);
      return;
    }
    gusts?.set(moment);
    lookup.advanceSome(dt_s, wind.pressureX, wind.pressureZ, changed.near, gusts);
  }

  /** The distant trees of a level whose turn it is. */
  turnsOf(level: number): Uint32Array {
    return this.changed?.far[level] ?? NO_TREES;
  }

  /**
   * Steps the distant trees of a level whose turn it is, in the wind that was updated at them, to a time (s), usually by a time (s), and writes their leading
   * coordinates and the wind speed.
   */
  stepFar(level: number, until_s: number, usual_s: number, out: Float32Array): void {
    const { lookup, levels, wind, modes } = this;
    const trees = this.turnsOf(level);
    const stride = poseStride(modes);
    const { pressureX, pressureZ } = wind;
    for (let k = 0; k < trees.length; k++) {
      const tree = trees[k];
      const to = tree * stride;
      const step_s = levels.stepTo(tree, until_s, usual_s);
      lookup.advanceFar(tree, step_s, level, pressureX[tree], pressureZ[tree], out, to);
      out[to + modes] = wind.speedAt_m_s(tree);
    }
  }

  /** Writes the trees that are stepped fully. */
  override write(out: Float32Array): void {
    const { lookup, changed, wind, modes } = this;
    if (!changed) {
      super.write(out);
      return;
    }
    const stride = poseStride(modes);
    const { q } = lookup;
    for (let k = 0; k < changed.near.length; k++) {
      const tree = changed.near[k];
      const to = tree * stride;
      for (let mode = 0; mode < modes; mode++) out[to + mode] = q[tree * modes + mode];
      out[to + modes] = wind.speedAt_m_s(tree);
    }
  }
}
