/**
 * Navier–Stokes eddies at any time. Successive solver runs are cross-faded, so that any time can be reached in at most
 * EPOCH + OVERLAP steps.
 */
import {
  EDDY_CELLS_PER_SCALE,
  EDDY_EPOCH,
  EDDY_GRID,
  EDDY_LATERAL_SHARE,
  EDDY_OVERLAP,
  EDDY_STEPS_PER_SCALE,
} from "../../constants";
import type { ResolvedWind } from "../document";
import { type Gusts, type Output, type Places, View } from "../frame";
import { hash32 } from "../hashing";
import { Eddies, PAST_STEPS, SLICE_COUNT } from "./navierStokes";
import { type Picture, samplePicture } from "./texture";

/** The solver run of one epoch. */
class Run {
  private readonly eddies: Eddies;

  constructor(
    seed: number,
    readonly epoch: number,
  ) {
    this.eddies = new Eddies(hash32(seed, epoch));
  }

  /**
   * Whether the interval between this step and the next can still be reached: a run only goes forward, but keeps an interval
   * more, because distant trees are stepped ahead of the others.
   */
  canReach(step: number): boolean {
    return this.eddies.steps <= step + PAST_STEPS;
  }

  /** Adds the weighted velocity at fraction t between a step and the next, and prepares the following step. */
  add(step: number, t: number, weight: number, picture: Picture): void {
    while (this.eddies.steps <= step) this.eddies.finish();
    const { eddies } = this;
    const ago = eddies.steps - step - 1;
    if (ago === 0) eddies.prepare(Math.ceil(t * SLICE_COUNT));
    const { u, v } = eddies.past(ago);
    const { u: beforeU, v: beforeV } = eddies.past(ago + 1);
    for (let i = 0; i < u.length; i++) {
      picture.along[i] += weight * ((1 - t) * beforeU[i] + t * u[i]);
      picture.across[i] += weight * ((1 - t) * beforeV[i] + t * v[i]);
    }
  }
}

export class EddyGusts implements Gusts {
  private runs: Run[] = [];
  private readonly view = new View(EDDY_LATERAL_SHARE);
  private shown = Number.NaN;
  private readonly picture: Picture = {
    along: new Float64Array(EDDY_GRID * EDDY_GRID),
    across: new Float64Array(EDDY_GRID * EDDY_GRID),
    columns: EDDY_GRID,
    rows: EDDY_GRID,
    cellsAlong: EDDY_CELLS_PER_SCALE,
    cellsAcross: EDDY_CELLS_PER_SCALE,
    slant: 0,
  };

  constructor(private readonly seed: number) {}

  velocity(wind: ResolvedWind, travel: number, x: Places, z: Places, outX: Output, outZ: Output): void {
    this.show(EDDY_STEPS_PER_SCALE * travel);
    this.view.set(wind, travel);
    samplePicture(this.picture, this.view, x, z, outX, outZ);
  }

  /** The texture at a time counted in steps; cached, because the groups of trees share it. */
  private show(moment: number): void {
    if (moment === this.shown) return;
    this.shown = moment;
    const step = Math.floor(moment);
    const epoch = Math.floor(step / EDDY_EPOCH);
    const fade = epoch <= 0 ? 1 : Math.min(1, (moment - epoch * EDDY_EPOCH) / EDDY_OVERLAP);
    this.picture.along.fill(0);
    this.picture.across.fill(0);
    // The next epoch's run may have begun for a later moment.
    if (this.runs.some((run) => Math.abs(run.epoch - epoch) > 1)) {
      this.runs = this.runs.filter((run) => Math.abs(run.epoch - epoch) <= 1);
    }
    if (fade < 1) this.add(epoch - 1, step, moment - step, Math.sqrt(1 - fade));
    this.add(epoch, step, moment - step, Math.sqrt(fade));
  }

  private add(epoch: number, step: number, t: number, weight: number): void {
    this.run(epoch, step).add(step - epoch * EDDY_EPOCH, t, weight, this.picture);
  }

  private run(epoch: number, step: number): Run {
    const old = this.runs.find((kept) => kept.epoch === epoch);
    if (old?.canReach(step - epoch * EDDY_EPOCH)) return old;
    const run = new Run(this.seed, epoch);
    this.runs = [...this.runs.filter((other) => other !== old), run];
    return run;
  }
}
