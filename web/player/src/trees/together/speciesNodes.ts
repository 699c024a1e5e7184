/** The nodes of one species in pass 1 of all species (togetherNodes.ts): which trees are drawn, and the poses that are due. */
import type { RenderTarget } from "three";
import type { Easing } from "../../core/motion/easedPoses";
import type { DrawnMotion, NodeLevel } from "../../core/table/drawnTable";
import type { DrawList } from "../drawList";
import { isSpacious, roomFor } from "../instanceData";
import { gatherPoses, PERIODS, type PoseRows } from "../nodes/levelPass";
import type { NodeRenderer } from "../nodes/nodeGraphics";
import { type LevelRows, levelRows } from "../nodes/nodeLayout";
import type { LevelTexels, TreeNodes } from "../nodes/treeNodes";
import type { PoseTexture } from "./poseTexture";

/** What a species has of the target, rows, and of the poses, texels. */
export interface Block {
  readonly row: number;
  readonly rows: number;
  readonly pose: number;
  readonly poses: number;
}

/** The nodes of all species. */
export interface SharedNodes {
  readonly target: RenderTarget;
  /** log2 of the target's width, as a uniform. */
  readonly shift: { value: number };
  readonly newest: PoseTexture;
  readonly before: PoseTexture;
  /** Gives a species a block for what it wants; all others may move. */
  assign(species: SpeciesNodes): void;
  /** Takes note that a species wants much less than it has; all may move. */
  release(species: SpeciesNodes): void;
  /** Call when poses of a species have changed, or its places. */
  changed(places: boolean): void;
  remove(species: SpeciesNodes): void;
  /** Draws the nodes of all species, unless they were drawn since this one last asked, and have not changed since. */
  render(by: SpeciesNodes, renderer: NodeRenderer): void;
}

export class SpeciesNodes implements TreeNodes {
  readonly levels: readonly NodeLevel[];
  /** Per level, the share of the newest poses; the rest is of those before. */
  readonly shares: Float32Array;
  /** Set by the nodes of all species. */
  block: Block = { row: 0, rows: 0, pose: 0, poses: 0 };
  texelsWanted = 0;
  posesWanted = 0;
  /** Frames since each level's last pose update. */
  private readonly ages: Uint8Array;
  /** Frames for which each level still shows the poses it had when other trees were selected. */
  private readonly waits: Uint8Array;
  /** Of each level, in the block. */
  private places: readonly LevelRows[];
  private readonly posesFrom: Int32Array;
  private list: DrawList | null = null;
  private told: (texels: readonly LevelTexels[]) => void = () => {};
  private poses: Float32Array | null = null;
  private easing: Easing | null = null;

  /** `turn`: species with different ones take the poses of distant trees in different frames. */
  constructor(
    private readonly all: SharedNodes,
    readonly motion: DrawnMotion,
    private readonly turn: number,
  ) {
    const { levels } = motion;
    this.levels = levels;
    this.shares = new Float32Array(levels.length).fill(1);
    this.ages = new Uint8Array(levels.length);
    this.waits = new Uint8Array(levels.length);
    this.places = levels.map(() => ({ row: 0, rows: 0, trees: 0 }));
    this.posesFrom = new Int32Array(levels.length);
  }

  get target() {
    return this.all.target;
  }

  get shift(): { value: number } {
    return this.all.shift;
  }

  /** Rows of the target, whose width is 2 to the power of `shift`. */
  rowsWanted(shift: number): number {
    return Math.ceil(this.texelsWanted / 2 ** shift) + this.levels.length;
  }

  /** Where a level is in the target and in the poses of all species. */
  placeOf(level: number): { row: number; trees: number; pose: number } {
    const { row, trees } = this.places[level];
    return { row: this.block.row + row, trees, pose: this.block.pose + this.posesFrom[level] };
  }

  private get texels(): readonly LevelTexels[] {
    return this.levels.map(({ nodes }, k) => {
      const { row, trees } = this.placeOf(k);
      return { first: row * 2 ** this.shift.value, trees, nodes };
    });
  }

  place(list: DrawList, told: (texels: readonly LevelTexels[]) => void): void {
    this.list = list;
    this.told = told;
    let [texels, poses] = [0, 0];
    this.levels.forEach(({ nodes, quads }, k) => {
      const trees = list.visible[k] + list.hidden[k];
      texels += nodes * trees;
      poses += quads * trees;
    });
    const grows = texels > this.texelsWanted || poses > this.posesWanted;
    if (grows || isSpacious(this.texelsWanted, texels)) {
      this.texelsWanted = roomFor(texels);
      this.posesWanted = roomFor(poses);
      if (grows) this.all.assign(this);
      else this.all.release(this);
    }
    this.placeTrees(list);
    told(this.texels);
  }

  /** Takes up its block, which has moved. */
  replace(): void {
    if (!this.list) return;
    this.placeTrees(this.list);
    this.told(this.texels);
  }

  private placeTrees(list: DrawList): void {
    const shift = this.shift.value;
    const layout = { width: 2 ** shift, height: this.block.rows, shift };
    const nodes = this.levels.map((level) => level.nodes);
    const trees = this.levels.map((_, k) => list.visible[k] + list.hidden[k]);
    this.places = levelRows(layout, nodes, trees);
    let poses = 0;
    for (const [k, { quads }] of this.levels.entries()) {
      this.posesFrom[k] = poses;
      poses += quads * this.places[k].trees;
    }
    this.all.changed(true);
    this.restart();
  }

  private get rows(): PoseRows | null {
    const { poses, easing, list, motion } = this;
    if (!poses || !list || poses.length < list.share.length * motion.stride) return null;
    const { order, start } = list;
    return { poses, easing, stride: motion.stride, wind: motion.modes, order, start };
  }

  /** Takes the newest poses of all drawn trees at once, because other trees are drawn. */
  private restart(): void {
    const { rows } = this;
    if (!rows) return;
    for (const [k] of this.levels.entries()) {
      this.gather(k, rows);
      this.ages[k] = PERIODS[k] - 1;
      this.waits[k] = this.turn % PERIODS[k];
      this.shares[k] = 1;
    }
  }

  setPoses(poses: Float32Array, easing: Easing | null): void {
    const first = this.poses === null;
    this.poses = poses;
    this.easing = easing;
    if (first) this.restart();
    else this.advance();
    this.all.changed(false);
  }

  /** Takes the poses of the levels that are due, and interpolates those of the others. */
  private advance(): void {
    const { rows, ages, waits } = this;
    if (!rows) return;
    for (const [k] of this.levels.entries()) {
      if (waits[k] > 0) {
        waits[k]--;
        continue;
      }
      const period = PERIODS[k];
      ages[k] = (ages[k] + 1) % period;
      if (ages[k] === 0) {
        if (period > 1) this.keepPoses(k);
        this.gather(k, rows);
      }
      this.shares[k] = (ages[k] + 1) / period;
    }
  }

  /** Keeps the poses of a level as those before the next. */
  private keepPoses(level: number): void {
    const { trees, pose } = this.placeOf(level);
    if (trees === 0) return;
    const { newest, before } = this.all;
    const end = pose + trees * this.levels[level].quads;
    before.data.set(newest.data.subarray(4 * pose, 4 * end), 4 * pose);
    before.mark(pose, end);
  }

  private gather(level: number, rows: PoseRows): void {
    const { trees, pose } = this.placeOf(level);
    if (trees === 0) return;
    const { newest } = this.all;
    gatherPoses(rows, this.levels[level], level, trees, newest.data, 4 * pose);
    newest.mark(pose, pose + trees * this.levels[level].quads);
  }

  render(renderer: NodeRenderer): void {
    this.all.render(this, renderer);
  }

  dispose(): void {
    this.all.remove(this);
  }
}
