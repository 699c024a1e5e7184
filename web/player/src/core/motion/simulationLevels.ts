/**
 * How often each tree of a group is stepped, by its distance from the viewer, and whether it is in view: near trees in every frame with the
 * full model, distant ones less often with coarse ones. These take turns in blocks of neighbours in memory, so that every frame costs the
 * same. Pure.
 */

/** Levels of distant trees: where they begin (m), and the table steps in one step of their coarse model. */
export const FAR_LEVELS = [
  { from_m: 150, steps: 4 },
  { from_m: 300, steps: 8 },
  { from_m: 500, steps: 8 },
  { from_m: 850, steps: 32 },
] as const;
/** Trees out of view that are at least this far away (m) have the level of seen trees so many times as far away. */
const UNSEEN_FROM_M = 80;
const UNSEEN_TIMES = 1.8;
/** How far (m) beside the view a tree may stand of which something is seen. */
const BESIDE_M = 12;
/** Steps per second of trees at the last level; each level before it takes twice as many. */
const SLOWEST_HZ = 0.9375;
/** Trees keep their level until they are this much (m) nearer than where it begins. */
const RETURN_M = 10;
/** Most frames from one step of these trees to the next. */
const MOST_FRAMES = 128;
/** Weight of a new frame in the mean length of frames, and how far that may change before the periods do. */
const NEW_FRAME = 0.1;
const LONGER_FROM = 1.9;
const SHORTER_FROM = 0.9;
/** The clock has jumped if a distant tree would have to be stepped by this many of its periods. */
const JUMP_PERIODS = 4;
/** Trees that take their turn together. */
const BLOCK_TREES = 32;

/**
 * Where the viewer is (x, z, m); the horizontal direction of the view (unit vector), and the cosine of the angle to it up to which something is
 * seen. Without these, everything is.
 */
export type Viewer = readonly [x_m: number, z_m: number, aheadX?: number, aheadZ?: number, cosine?: number];

/** The trees that are stepped in one frame. */
export interface Turn {
  /** To the end of the frame. */
  readonly near: Uint32Array;
  /** By level: ahead, to a pose that is reached `periods` frames after the one before this. */
  readonly far: readonly Uint32Array[];
  readonly periods: readonly number[];
}

/** Counts frames, and how many the trees at the last level wait for their turn at the present frame rate, with a hysteresis. */
export class FramePace {
  frame = 0;
  /** Mean length of a frame, s. */
  frame_s = 0;
  /** Frames between the steps of these trees, a power of two. */
  period = 0;

  /** Begins a frame that lasts dt_s > 0. */
  next(dt_s: number): void {
    this.frame++;
    this.frame_s += (this.frame_s === 0 ? 1 : NEW_FRAME) * (dt_s - this.frame_s);
    const frames = Math.min(MOST_FRAMES, 1 / (SLOWEST_HZ * this.frame_s));
    if (this.period === 0) this.period = 2 ** Math.round(Math.log2(Math.max(1, frames)));
    while (frames >= LONGER_FROM * this.period) this.period *= 2;
    while (this.period > 1 && frames < SHORTER_FROM * this.period) this.period /= 2;
  }

  /** Frames between the steps of a level of distant trees. */
  periodOf(level: number): number {
    return Math.max(1, this.period >> (FAR_LEVELS.length - 1 - level));
  }
}

export class SimulationLevels {
  /** Level of each tree: 0 near, then those of FAR_LEVELS. */
  private readonly level: Uint8Array;
  /** The lowest level in each block, where it begins, and when it has its turn. */
  private readonly lowest: Uint8Array;
  private readonly starts: Uint32Array;
  private readonly turns: Uint32Array;
  /** Time to which each distant tree has been stepped. */
  private readonly until_s: Float64Array;
  private readonly lists: readonly Uint32Array[];
  private readonly kept = new Set<number>();
  private viewer: Viewer | null = null;
  private placed = false;

  /**
   * Where the trees stand, m. `left`: called for each tree that becomes distant. `rows`: index of each tree among more, by which
   * it has its turns, in ascending order; null: these are all.
   */
  constructor(
    private readonly x: Float32Array,
    private readonly z: Float32Array,
    private readonly left: (tree: number) => void,
    rows: Uint32Array | null = null,
  ) {
    this.level = new Uint8Array(x.length);
    const { starts, turns } = blocksOf(x.length, rows);
    this.starts = Uint32Array.from(starts);
    this.turns = Uint32Array.from(turns);
    this.lowest = new Uint8Array(turns.length);
    this.until_s = new Float64Array(x.length);
    this.lists = Array.from({ length: 1 + FAR_LEVELS.length }, () => new Uint32Array(x.length));
  }

  /** Until this is called, all trees are near. */
  see(viewer: Viewer): void {
    this.viewer = viewer;
  }

  /** Steps these trees fully from now on, and others by their distance again. */
  keepNear(trees: readonly number[]): void {
    this.kept.clear();
    for (const tree of trees) {
      this.kept.add(tree);
      this.level[tree] = 0;
      this.lowest[this.starts.findLastIndex((start) => start <= tree)] = 0;
    }
  }

  /** Takes over the levels of trees that existed before; `rows`: their index there, −1 for a new tree. */
  adopt(from: SimulationLevels, rows: Int32Array): void {
    rows.forEach((row, tree) => {
      if (row < 0) return;
      this.level[tree] = from.level[row];
      this.until_s[tree] = from.until_s[row];
    });
    for (let block = 0; block < this.lowest.length; block++) this.sumUp(block);
    this.viewer = from.viewer;
    // new trees among them get their level in their turn
    this.placed = from.placed;
  }

  /** The trees to step in a frame that begins at a time (s) and lasts some. */
  begin(time_s: number, pace: FramePace): Turn {
    const { level, lowest, lists, starts, turns } = this;
    if (this.viewer && !this.placed) {
      for (let block = 0; block < lowest.length; block++) this.update(block, time_s);
      this.placed = true;
    }
    const counts = lists.map(() => 0);
    const periods = FAR_LEVELS.map((_, k) => pace.periodOf(k));
    for (let block = 0; block < lowest.length; block++) {
      const turn = turns[block] + pace.frame;
      // the highest level whose turn it is, and with it all below
      let most = periods.length;
      while (most > 0 && (turn & (periods[most - 1] - 1)) !== 0) most--; // periods are powers of two
      if (most >= periods.length - 1) this.update(block, time_s); // about twice a second
      if (lowest[block] > most) continue;
      for (let tree = starts[block]; tree < starts[block + 1]; tree++) {
        const own = level[tree];
        if (own <= most) lists[own][counts[own]++] = tree;
      }
    }
    const [near, ...far] = lists.map((list, k) => list.subarray(0, counts[k]));
    return { near, far, periods };
  }

  /**
   * Time (s) by which a distant tree is to be stepped to be at a time (s), where it is from then on. Where the clock has jumped,
   * that is `usual_s`.
   */
  stepTo(tree: number, until_s: number, usual_s: number): number {
    const step_s = until_s - this.until_s[tree];
    if (Math.abs(step_s) > JUMP_PERIODS * usual_s) {
      this.until_s[tree] = until_s;
      return usual_s;
    }
    if (step_s <= 0) return 0;
    this.until_s[tree] = until_s;
    return step_s;
  }

  /** Gives the trees of a block their levels by distance. */
  private update(block: number, time_s: number): void {
    const { viewer, x, z, level, kept, starts } = this;
    if (!viewer) return;
    const [fromX, fromZ, aheadX = 0, aheadZ = 0, cosine = -1] = viewer;
    for (let tree = starts[block]; tree < starts[block + 1]; tree++) {
      const dx = x[tree] - fromX;
      const dz = z[tree] - fromZ;
      const away_m = Math.sqrt(dx * dx + dz * dz);
      const isSeen = away_m < UNSEEN_FROM_M || dx * aheadX + dz * aheadZ >= cosine * away_m - BESIDE_M;
      const before = level[tree];
      const now =
        kept.size > 0 && kept.has(tree) ? 0 : levelAt(isSeen ? away_m : UNSEEN_TIMES * away_m, before);
      level[tree] = now;
      if (before > 0 || now === 0) continue;
      this.until_s[tree] = time_s;
      this.left(tree);
    }
    this.sumUp(block);
  }

  private sumUp(block: number): void {
    let lowest: number = FAR_LEVELS.length;
    const { starts, level } = this;
    for (let tree = starts[block]; tree < starts[block + 1]; tree++) lowest = Math.min(lowest, level[tree]);
    this.lowest[block] = lowest;
  }
}

/** Where the blocks of trees begin, and the end of the last one; and when they have their turns. */
function blocksOf(count: number, rows: Uint32Array | null): { starts: number[]; turns: number[] } {
  const [starts, turns]: number[][] = [[], []];
  for (let tree = 0; tree < count; tree++) {
    const turn = Math.floor((rows ? rows[tree] : tree) / BLOCK_TREES);
    if (turn === turns[turns.length - 1]) continue;
    starts.push(tree);
    turns.push(turn);
  }
  return { starts: [...starts, count], turns };
}

/** The level at a distance; `before` is the present one. */
function levelAt(away_m: number, before: number): number {
  let level = 0;
  while (level < FAR_LEVELS.length && away_m >= FAR_LEVELS[level].from_m - (before > level ? RETURN_M : 0))
    level++;
  return level;
}
