/** The background trees of one species: selection, motion and cards. */

import type { TableMotion } from "galewood/client";
import type { View } from "galewood/trees";
import {
  type Bounds,
  createInstanceData,
  cylinderSeen,
  INSTANCE_FLOATS,
  type InstanceData,
  type Placement,
  setTints,
  shadowSeen,
  type Tint,
} from "galewood/trees";
import { heightFactor, type WindField } from "galewood/wind";
import { groundHeight_m } from "../ground/landscape";
import { BEND_FLOATS, CARD_FLOATS, type CardList, type Cards } from "../impostors/cards";
import { Sway, TIP_FLOATS } from "../impostors/sway";
import { growthAt, rankOf, shareDrawn, type Thinning } from "./farPlaces";

/** Cards are drawn near to far, in bins. */
const DISTANCE_BINS = 32;
const BIN_M = 16;
/**
 * From near, a picture of a tree is too coarse: background trees dissolve before. Each has its own distance between `gone`
 * and `gone + spread`, so that few are transparent at a time.
 */
const CLEAR_M = { gone: 30, spread: 14, fade: 1.5 } as const;
/** Height of the middle of the crown relative to the tree's. Distances are measured to it, so that an eye just above the crowns is near them. */
const CROWN_HEIGHT_SHARE = 0.6;
/** Trees whose rank is this close to the share that is drawn are dissolving. */
const FADE_RANK = 0.03;
/** A number between 0 and 1 that differs between neighbours. */
const chance = (tree: number) => (tree * 0.618034) % 1;
/** Below this elevation of the sun, shadows do not get longer. */
const LOWEST_SUN = 0.15;
/** Largest sway of the cards, for their bounds, relative to the height. */
const MAX_SWAY_SHARE = 0.15;

/** A wind field at a time. */
interface Air {
  readonly field: WindField;
  readonly time_s: number;
}

export class FarTrees {
  private readonly instances: InstanceData;
  private readonly x: Float32Array;
  private readonly z: Float32Array;
  private readonly factor: Float32Array;
  private readonly bins: Uint8Array;
  private readonly before: Float32Array;
  private readonly ranks: Float32Array;
  private readonly seen: Uint32Array;
  private readonly casting: Uint32Array;
  /** Trees that are drawn or cast shadows, which alone are moved, and whether each tree is one of them. */
  private drawn = new Uint32Array(0);
  private isDrawn: Uint8Array;
  /** The wind in which they have moved last. */
  private air: Air | null = null;
  private sway: Sway | null = null;
  private moves: TableMotion | null = null;
  /** What the height factors were computed for. */
  private heights = "";

  constructor(
    private readonly places: readonly Placement[],
    private readonly thinning: Thinning,
    tint: Tint,
  ) {
    const count = places.length;
    this.instances = createInstanceData(places, groundHeight_m, tint);
    this.x = Float32Array.from(places, ({ x_m }) => x_m);
    this.z = Float32Array.from(places, ({ z_m }) => z_m);
    this.ranks = Float32Array.from(places, rankOf);
    this.factor = new Float32Array(count);
    this.bins = new Uint8Array(count);
    this.before = new Float32Array(TIP_FLOATS * count);
    this.seen = new Uint32Array(count);
    this.casting = new Uint32Array(count);
    this.isDrawn = new Uint8Array(count);
  }

  get count(): number {
    return this.places.length;
  }

  /** x, z, height and crown radius of each tree, packed. */
  shading(height_m: number, radius_m: number): number[] {
    return this.places.flatMap(({ x_m, z_m, scale }) => [x_m, z_m, scale * height_m, 0.8 * scale * radius_m]);
  }

  setTints(tint: Tint): void {
    setTints(this.instances, tint);
  }

  /** Chooses the cards to draw in this view, near to far, and those whose shadows can be seen. */
  select(cards: Cards, view: View): void {
    const { height_m, reach, across_m } = cards.atlas.box;
    const bounds = { height_m, radius_m: reach * across_m, reach_m: MAX_SWAY_SHARE * height_m };
    const seen = this.sortByDistance(bounds, view);
    const casting = this.chooseCasters(bounds, view);
    this.takeDrawn(this.seen.subarray(0, seen), this.casting.subarray(0, casting));
    this.fill(cards.seen, this.seen, seen, height_m, view);
    this.fill(cards.casting, this.casting, casting, height_m, view);
  }

  private sortByDistance(bounds: Bounds, { planes, eye }: View): number {
    const { data, count } = this.instances;
    const first = new Uint32Array(DISTANCE_BINS + 1);
    for (let tree = 0; tree < count; tree++) {
      const at = tree * INSTANCE_FLOATS;
      const scale = data[at + 6];
      const height_m = bounds.height_m * scale;
      const radius_m = (bounds.radius_m + bounds.reach_m) * scale;
      if (!cylinderSeen(planes, data[at], data[at + 1], data[at + 2], height_m, radius_m)) {
        this.bins[tree] = DISTANCE_BINS;
        continue;
      }
      const distance_m = this.distance_m(tree, bounds.height_m, eye);
      if (distance_m < CLEAR_M.gone || this.ranks[tree] >= shareDrawn(distance_m, this.thinning)) {
        this.bins[tree] = DISTANCE_BINS;
        continue;
      }
      this.bins[tree] = Math.min(DISTANCE_BINS - 1, Math.floor(distance_m / BIN_M));
      first[this.bins[tree] + 1]++;
    }
    for (let bin = 1; bin <= DISTANCE_BINS; bin++) first[bin] += first[bin - 1];
    const seen = first[DISTANCE_BINS];
    for (let tree = 0; tree < count; tree++) {
      if (this.bins[tree] < DISTANCE_BINS) this.seen[first[this.bins[tree]]++] = tree;
    }
    return seen;
  }

  private chooseCasters(bounds: Bounds, { planes, eye, sun, shadow_m }: View): number {
    const { data, count } = this.instances;
    let casters = 0;
    for (let tree = 0; tree < count; tree++) {
      const at = tree * INSTANCE_FLOATS;
      const scale = data[at + 6];
      const half_m = 0.5 * bounds.height_m * scale;
      const ball_m = Math.hypot(half_m, bounds.radius_m * scale);
      const slide_m = (2 * half_m) / Math.max(LOWEST_SUN, sun.y);
      const [x, y, z] = [data[at], data[at + 1] + half_m, data[at + 2]];
      const away_m = Math.hypot(x - eye.x, y - eye.y, z - eye.z);
      if (this.ranks[tree] >= shareDrawn(away_m, this.thinning)) continue;
      const nearest_m = away_m - ball_m - slide_m;
      if (nearest_m > shadow_m || nearest_m + ball_m + slide_m < CLEAR_M.gone) continue;
      if (!shadowSeen(planes, sun, x, y, z, ball_m, slide_m)) continue;
      this.casting[casters++] = tree;
    }
    return casters;
  }

  /** Trees that come into view are at rest in the wind, as they have not moved meanwhile. */
  private takeDrawn(seen: Uint32Array, casting: Uint32Array): void {
    const isDrawn = new Uint8Array(this.count);
    const drawn = [...seen, ...casting].filter((tree) => {
      const first = isDrawn[tree] === 0;
      isDrawn[tree] = 1;
      return first;
    });
    this.settle(Uint32Array.from(drawn.filter((tree) => this.isDrawn[tree] === 0)));
    this.drawn = Uint32Array.from(drawn);
    this.isDrawn = isDrawn;
  }

  private settle(trees: Uint32Array): void {
    const { sway, moves, air, before } = this;
    if (!sway || !moves || !air || trees.length === 0) return;
    const [x, z] = this.pressures(trees, moves, air);
    sway.settle(trees, x, z);
    for (const tree of trees) {
      const at = TIP_FLOATS * tree;
      before[at] = sway.tips[at];
      before[at + 1] = sway.tips[at + 1];
    }
  }

  /** Pressure at each of these trees, Pa, along x and z. */
  private pressures(trees: Uint32Array, { sway }: TableMotion, { field, time_s }: Air) {
    const [x, z, atX, atZ, factor] = Array.from({ length: 5 }, () => new Float32Array(trees.length));
    for (let i = 0; i < trees.length; i++) {
      atX[i] = this.x[trees[i]];
      atZ[i] = this.z[trees[i]];
      factor[i] = this.factor[trees[i]];
    }
    field.pressure(atX, atZ, field.at(time_s), x, z, sway.streamlined, factor);
    return [x, z];
  }

  private fill(list: CardList, trees: Uint32Array, count: number, height_m: number, { eye }: View): void {
    list.reserve(count);
    const { data } = list;
    for (let i = 0; i < count; i++) {
      const from = trees[i] * INSTANCE_FLOATS;
      const to = i * CARD_FLOATS;
      for (let k = 0; k < CARD_FLOATS; k++) data[to + k] = this.instances.data[from + k];
      const distance_m = this.distance_m(trees[i], height_m, eye);
      const share = shareDrawn(distance_m, this.thinning);
      const growth = growthAt(share);
      for (let k = 4; k < 7; k++) data[to + k] *= growth; // scale times cosine and sine of the yaw, and scale
      data[to + 3] = Math.min(
        this.nearOpacity(trees[i], distance_m),
        (share - this.ranks[trees[i]]) / FADE_RANK,
      );
      data[to + 7] = chance(trees[i]);
    }
    this.writeBend(list, trees, count);
    list.show(count);
  }

  /** From the eye to the middle of the crown; `height_m`: of the species' tree of scale 1. */
  private distance_m(tree: number, height_m: number, eye: View["eye"]): number {
    const { data } = this.instances;
    const at = tree * INSTANCE_FLOATS;
    const y = data[at + 1] + CROWN_HEIGHT_SHARE * height_m * data[at + 6];
    return Math.hypot(data[at] - eye.x, y - eye.y, data[at + 2] - eye.z);
  }

  /** Of trees that dissolve before the eye. */
  private nearOpacity(tree: number, distance_m: number): number {
    const gone_m = CLEAR_M.gone + CLEAR_M.spread * chance(tree);
    return Math.min(1, Math.max(0, (distance_m - gone_m) / CLEAR_M.fade));
  }

  private writeBend({ bend }: CardList, trees: Uint32Array, count: number): void {
    const { before } = this;
    const tips = this.sway?.tips ?? before;
    for (let i = 0; i < count; i++) {
      const tree = TIP_FLOATS * trees[i];
      const to = BEND_FLOATS * i;
      bend[to] = before[tree];
      bend[to + 1] = before[tree + 1];
      bend[to + 2] = tips[tree];
      bend[to + 3] = tips[tree + 1];
    }
  }

  /** Advances the trees that are drawn in the wind at a time; the cards then move towards their new poses. */
  advance(dt_s: number, time_s: number, field: WindField, motion: TableMotion, cards: Cards | null): void {
    const { wind } = field.at(time_s);
    this.air = { field, time_s };
    this.setHeights(motion.height_m, wind.height_exponent, wind.reference_height_m);
    if (this.moves !== motion) this.take(motion);
    if (!this.sway) return;
    this.before.set(this.sway.tips);
    const [x, z] = this.pressures(this.drawn, motion, this.air);
    this.sway.advance(dt_s, this.drawn, x, z, wind.mean_speed_m_s);
    if (!cards) return;
    this.writeBend(cards.seen, this.seen, cards.seen.count);
    cards.seen.moved();
    this.writeBend(cards.casting, this.casting, cards.casting.count);
    cards.casting.moved();
  }

  /** Goes on with another table, from the present motion. */
  private take(motion: TableMotion): void {
    const before = this.sway;
    const scales = Float32Array.from(this.places, ({ scale }) => scale);
    this.sway = new Sway(motion.sway, motion.height_m, scales);
    this.moves = motion;
    if (before) this.sway.adopt(before);
    else this.settle(this.drawn);
  }

  /** Wind speed at the height of each tree relative to the reference height. */
  private setHeights(height_m: number, exponent: number, reference_m: number): void {
    const key = `${height_m} ${exponent} ${reference_m}`;
    if (key === this.heights) return;
    this.heights = key;
    this.places.forEach(({ scale }, tree) => {
      this.factor[tree] = heightFactor(height_m * scale, exponent, reference_m);
    });
  }
}
