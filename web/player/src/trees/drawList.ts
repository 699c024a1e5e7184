/** Selects the trees of a frame, their levels of detail and the shadow casters. Pure; no allocation per frame. */
import { LEVEL_SHARES } from "../core/constants";
import { fadeAt } from "./crossFade";
import { type Bounds, cylinderSeen, type Planes, type Point, shadowSeen } from "./culling/culling";
import { type Chunk, chunksOf } from "./culling/treeChunks";
import { CARD_LEVEL, LEVEL_COUNT, levelFor, NODE_LEVEL_COUNT, sharesOf } from "./detail";
import { INSTANCE_FLOATS, type InstanceData } from "./instanceData";

export interface View {
  readonly planes: Planes;
  readonly eye: Point;
  /** Direction towards the sun. */
  readonly sun: Point;
  /** Distances (m) up to which a tree of scale 1 shows all its leaves, and at which it shows a fifth. */
  readonly levelFrom_m: readonly [number, number];
  /** Distance (m) below which a tree of scale 1 shows its near parts, if it has any; never without it. */
  readonly near_m?: number;
  /** Distance (m) from the eye up to which leaves are drawn one by one; none without it. */
  readonly close_m?: number;
  /** Shadows are drawn up to this distance. */
  readonly shadow_m: number;
  /** Whether all trees up to it cast them, because light comes from elsewhere than the sun. */
  readonly allCast?: boolean;
  /** Distance (m) from which a tree of scale 1 is replaced by its impostor; never without it. */
  readonly cardsFrom_m?: number;
}

/** Distance bins: trees are drawn near to far, so that hidden fragments are not shaded; the first has those that show near parts. */
const DISTANCE_BINS = 16;
const BIN_M = 12;
const CLASS_COUNT = 2 * NODE_LEVEL_COUNT * DISTANCE_BINS;
/** Casters are sorted by the smallest distance from the eye to their shadow. */
const CAST_BINS = 32;
const CAST_BIN_M = 6;
const NO_LEVEL = 255;
/** Smallest share of the pieces while a tree gives way to its impostor. */
const LEAST_SHOWN = 1e-3;
/** Below this elevation of the sun, shadows do not get longer. */
const LOWEST_SUN = 0.15;

/** Whether a tree of a chunk may be seen or cast a shadow that is. */
function matters(chunk: Chunk, { height_m, radius_m, reach_m, low_m = 0 }: Bounds, view: View): boolean {
  const { x, z, lowest_m, highest_m, scale } = chunk;
  const across_m = chunk.radius_m + (radius_m + reach_m) * scale;
  const tall_m = height_m * scale;
  const low = lowest_m + Math.min(0, scale * low_m);
  if (cylinderSeen(view.planes, x, low, z, highest_m + Math.max(0, scale * low_m) + tall_m - low, across_m))
    return true;
  const away_m = Math.hypot(x - view.eye.x, z - view.eye.z) - across_m;
  return away_m - tall_m * (1 + 1 / Math.max(LOWEST_SUN, view.sun.y)) <= view.shadow_m;
}

/**
 * Per level, the trees `order[start ...]`: first `visible` ones near to far, those that show near parts before all others, then
 * `hidden` ones that have no mesh, or only cast. The last level has those that are cards only.
 */
export class DrawList {
  readonly order: Uint32Array;
  readonly start = new Uint32Array(NODE_LEVEL_COUNT);
  readonly visible = new Uint32Array(NODE_LEVEL_COUNT);
  readonly hidden = new Uint32Array(NODE_LEVEL_COUNT);
  drawn = 0;
  /** Indices in `order` of the casters of each level, sorted by the distance of their shadow. */
  readonly casters: Uint32Array;
  readonly castStart = new Uint32Array(LEVEL_COUNT);
  /** [levels, bins + 1] number of casters in nearer bins. */
  readonly castBefore = new Uint32Array(LEVEL_COUNT * (CAST_BINS + 1));
  /** Share of pieces that each tree shows. */
  readonly share: Float32Array;
  /** The same in shadow maps, where impostors do not replace a tree. */
  readonly castShare: Float32Array;
  /** Opacity of the impostor of each visible tree. */
  readonly card: Float32Array;
  /** Level of each tree's mesh, for the hysteresis; 255 at first. */
  readonly level: Uint8Array;
  private readonly classes: Uint8Array;
  private readonly chunks: readonly Chunk[];
  /** The trees of chunks that are not culled as a whole. */
  private readonly candidates: Uint32Array;
  private candidateCount = 0;
  private shareAt: (distance_m: number) => number = () => 1;
  private readonly castBin: Uint8Array;
  private readonly next = new Uint32Array(CLASS_COUNT);
  private readonly tally = new Uint32Array(CLASS_COUNT);

  constructor(private readonly instances: InstanceData) {
    const { count } = instances;
    this.order = new Uint32Array(count);
    this.casters = new Uint32Array(count);
    this.share = new Float32Array(count);
    this.castShare = new Float32Array(count);
    this.card = new Float32Array(count);
    this.level = new Uint8Array(count).fill(NO_LEVEL);
    this.classes = new Uint8Array(count);
    this.castBin = new Uint8Array(count);
    this.chunks = chunksOf(instances);
    this.candidates = new Uint32Array(count);
  }

  select(bounds: Bounds, view: View): void {
    this.candidateCount = 0;
    this.shareAt = sharesOf(view.levelFrom_m, view.near_m);
    for (const chunk of this.chunks) {
      if (!matters(chunk, bounds, view)) continue;
      this.candidates.set(chunk.trees, this.candidateCount);
      this.candidateCount += chunk.trees.length;
      for (const tree of chunk.trees) this.classify(tree, bounds, view);
    }
    this.sortTrees();
    this.sortCasters();
  }

  private classify(tree: number, bounds: Bounds, view: View): void {
    const { data } = this.instances;
    const { eye, planes } = view;
    const at = tree * INSTANCE_FLOATS;
    const scale = data[at + 6];
    const x = data[at];
    const y = data[at + 1] + scale * (bounds.low_m ?? 0);
    const z = data[at + 2];
    const height_m = bounds.height_m * scale;
    const radius_m = (bounds.radius_m + bounds.reach_m) * scale;
    const distance_m = Math.sqrt((x - eye.x) ** 2 + (y + 0.5 * height_m - eye.y) ** 2 + (z - eye.z) ** 2);
    const seen = cylinderSeen(planes, x, y, z, height_m, radius_m);
    this.castBin[tree] = this.castBinOf(x, y, z, height_m, radius_m, distance_m, view);
    this.card[tree] = 0;
    if (!seen && this.castBin[tree] === NO_LEVEL) {
      this.classes[tree] = NO_LEVEL;
      return;
    }
    const pieces = this.detail(tree, distance_m / scale, seen, view);
    const drawn = seen && pieces > 0;
    const level = drawn || this.castBin[tree] !== NO_LEVEL ? this.level[tree] : CARD_LEVEL;
    const near = this.share[tree] > 1;
    const bin = near ? 0 : Math.min(DISTANCE_BINS - 1, 1 + Math.floor(distance_m / BIN_M));
    this.classes[tree] = (2 * level + (drawn ? 0 : 1)) * DISTANCE_BINS + bin;
  }

  /** Sets level and shares of a tree; returns the share of its pieces that its impostor leaves. */
  private detail(tree: number, distance_m: number, seen: boolean, view: View): number {
    const share = this.shareAt(distance_m);
    const { card, pieces } = fadeAt(distance_m, view.cardsFrom_m ?? Number.POSITIVE_INFINITY);
    if (seen) this.card[tree] = card;
    const shown = Math.max(LEAST_SHOWN, share * pieces);
    this.share[tree] = pieces === 1 ? share : shown;
    this.level[tree] = levelFor(this.share[tree], this.level[tree]);
    this.castShare[tree] = Math.min(
      1,
      pieces === 1 ? share : Math.min(share, LEVEL_SHARES[this.level[tree]]),
    );
    return pieces;
  }

  /** Bin of the smallest distance from the eye to the tree's shadow; NO_LEVEL if it is not drawn. */
  private castBinOf(
    x: number,
    y: number,
    z: number,
    height_m: number,
    radius_m: number,
    distance_m: number,
    view: View,
  ): number {
    const ball_m = Math.sqrt(0.25 * height_m * height_m + radius_m * radius_m);
    const slide_m = height_m / Math.max(LOWEST_SUN, view.sun.y);
    const nearest_m = distance_m - ball_m - slide_m;
    if (nearest_m > view.shadow_m) return NO_LEVEL;
    if (!view.allCast && !shadowSeen(view.planes, view.sun, x, y + 0.5 * height_m, z, ball_m, slide_m))
      return NO_LEVEL;
    return Math.min(CAST_BINS - 1, Math.max(0, Math.floor(nearest_m / CAST_BIN_M)));
  }

  private sortTrees(): void {
    const { classes, tally, next, order, candidates, candidateCount } = this;
    tally.fill(0);
    for (let k = 0; k < candidateCount; k++) {
      const own = classes[candidates[k]];
      if (own !== NO_LEVEL) tally[own]++;
    }
    this.layOut();
    for (let k = 0; k < candidateCount; k++) {
      const own = classes[candidates[k]];
      if (own !== NO_LEVEL) order[next[own]++] = candidates[k];
    }
  }

  /** Computes the ranges from the counts; `next` is the start of each class. */
  private layOut(): void {
    this.visible.fill(0);
    this.hidden.fill(0);
    let at = 0;
    for (let c = 0; c < CLASS_COUNT; c++) {
      const group = Math.floor(c / DISTANCE_BINS);
      const level = group >> 1;
      if (c % (2 * DISTANCE_BINS) === 0) this.start[level] = at;
      this.next[c] = at;
      (group & 1 ? this.hidden : this.visible)[level] += this.tally[c];
      at += this.tally[c];
    }
    this.drawn = at;
  }

  private sortCasters(): void {
    const { castBefore, castStart, casters, order, castBin, next, start } = this;
    castBefore.fill(0);
    let total = 0;
    for (let level = 0; level < LEVEL_COUNT; level++) {
      const row = level * (CAST_BINS + 1);
      const end = start[level] + this.visible[level] + this.hidden[level];
      for (let i = start[level]; i < end; i++) {
        const bin = castBin[order[i]];
        if (bin !== NO_LEVEL) castBefore[row + bin + 1]++;
      }
      castStart[level] = total;
      for (let bin = 0; bin < CAST_BINS; bin++) {
        next[bin] = total + castBefore[row + bin];
        castBefore[row + bin + 1] += castBefore[row + bin];
      }
      for (let i = start[level]; i < end; i++) {
        const bin = castBin[order[i]];
        if (bin !== NO_LEVEL) casters[next[bin]++] = i;
      }
      total += castBefore[row + CAST_BINS];
    }
  }

  /** Number of casters of a level, from `castStart` on, whose shadow may fall within a distance of the eye. */
  castersWithin(level: number, distance_m: number): number {
    const bins = Math.min(CAST_BINS, Math.max(0, Math.floor(distance_m / CAST_BIN_M) + 1));
    return this.castBefore[level * (CAST_BINS + 1) + bins];
  }
}
