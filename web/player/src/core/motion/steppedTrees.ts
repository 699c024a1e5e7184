/** The trees of one table, stepped by the wind at each of them: the modal or the paper's method. */
import type { PlaceGusts } from "../modal/placeGusts";
import type { Moment } from "../wind/transition";
import type { Chosen, GroupWind } from "./groupWind";
import { poseStride } from "./poseStride";
import type { Viewer } from "./simulationLevels";
import type { TreeInstances } from "./treeInstances";

/** Maximum step of wind and poses, so that the motion does not depend on the frame rate. */
const MAX_STEP_S = 1 / 30;

/**
 * Distances from the viewer up to which gusts within crowns move trees fully, and at all: at 80 m a pixel of a picture
 * 720 pixels high is 9 cm, more than branches move relative to the crown.
 */
const FULL_M = 50;
const GONE_M = 80;

/** Throws RangeError unless it is a time by which a forest can advance, s. */
export function checkStep(dt_s: number): void {
  if (!(dt_s >= 0 && dt_s < Infinity)) throw new RangeError(`dt_s: expected seconds from 0 on, not ${dt_s}`);
}

/** Number and length of the steps that make up a frame. Throws RangeError for what is no time. */
export function stepsOf(dt_s: number): { steps: number; step_s: number } {
  checkStep(dt_s);
  const steps = Math.max(1, Math.ceil(dt_s / MAX_STEP_S - 1e-9));
  return { steps, step_s: dt_s / steps };
}

export class SteppedTrees<Lookup extends TreeInstances = TreeInstances> {
  /** `gusts`: within the crowns, only with the modal method. */
  constructor(
    readonly lookup: Lookup,
    readonly gusts: PlaceGusts | null,
    readonly wind: GroupWind,
    readonly modes: number,
  ) {
    lookup.setTrees(wind.x, wind.z, wind.column(2), wind.column(3));
  }

  /** Trees far from the viewer do without the gusts within their crowns. */
  see(viewer: Viewer): void {
    for (let tree = 0; tree < this.wind.count; tree++) this.seeOne(tree, viewer);
  }

  protected seeOne(tree: number, viewer: Viewer): void {
    const { wind, gusts } = this;
    if (!gusts) return;
    const dx = wind.x[tree] - viewer[0];
    const dz = wind.z[tree] - viewer[1];
    const far_m = Math.sqrt(dx * dx + dz * dz); // many times faster than Math.hypot
    gusts.share[tree] = Math.min(1, Math.max(0, (GONE_M - far_m) / (GONE_M - FULL_M)));
  }

  /** The trees that `step` advances. */
  get stepped(): Chosen {
    return null;
  }

  /** Call after the update of the wind at these trees. */
  step(dt_s: number, moment: Moment): void {
    const { lookup, gusts, wind } = this;
    gusts?.set(moment);
    lookup.advance(dt_s, wind.pressureX, wind.pressureZ, gusts);
  }

  /** Writes `poseStride(modes)` floats per tree: the modes, then the wind speed. */
  write(out: Float32Array): void {
    const { lookup, wind, modes } = this;
    const stride = poseStride(modes);
    const { q } = lookup;
    for (let tree = 0, from = 0, to = 0; tree < lookup.count; tree++, to += stride, from += modes) {
      for (let k = 0; k < modes; k++) out[to + k] = q[from + k];
    }
    wind.writeSpeeds(out, modes);
  }
}
