/** The background forest beyond the simulated trees: impostors of the same species that sway in the same wind. */

import type { View } from "galewood/trees";
import { WindField, type WindState } from "galewood/wind";
import { Group } from "three";
import type { TreeAsset } from "../forest";
import { Cards } from "../impostors/cards";
import type { ImpostorLibrary } from "../impostors/library";
import type { Quality } from "../quality";
import { leafTint } from "../season/palette";
import type { Season } from "../season/season";
import { farPlaces, plantFar, THINNING_LEVELS } from "./farPlaces";
import { FarTrees } from "./farTrees";

/** What the simulated forest consists of. */
export interface Planted {
  /** Distance of the outermost tree from the centre, m. */
  readonly edge_m: number;
  readonly seed: number;
  readonly density: number;
  readonly shares: Readonly<Record<string, number>>;
  readonly assets: readonly TreeAsset[];
}

/** Each species takes new poses every so many frames, one after the other. */
const POSE_PERIOD_FRAMES = 8;
/** Longer pauses are skipped. */
const LONGEST_S = 1;

/** The trees of one species. */
interface Stand {
  readonly trees: FarTrees;
  cards: Cards | null;
  /** Frames since its last poses, and the time of these. */
  age: number;
  time_s: number;
}

export class FarWood {
  readonly group = new Group();
  private readonly stands = new Map<string, Stand>();
  private assets: readonly TreeAsset[] = [];
  private key = "";
  private season: Season = "autumn";
  private field: WindField | null = null;
  private frame = 0;
  private time_s = 0;

  constructor(private readonly library: ImpostorLibrary) {}

  /** Plants the background around a simulated forest. */
  populate(planted: Planted, quality: Quality): void {
    const { edge_m, seed, density, shares } = planted;
    this.assets = planted.assets;
    const builtin = planted.assets.filter((asset) => asset.builtin && asset.hasTable);
    const key = JSON.stringify([
      Math.round(edge_m),
      seed,
      density,
      shares,
      quality,
      builtin.map(({ id }) => id),
    ]);
    if (key === this.key) return;
    this.key = key;
    this.clear();
    const places = farPlaces(edge_m, seed, density);
    const tree = plantFar(builtin, places, shares);
    builtin.forEach(({ id, species }, k) => {
      const own = places.filter((_, i) => tree[i] === k);
      if (own.length === 0) return;
      const trees = new FarTrees(own, THINNING_LEVELS[quality], (place) =>
        leafTint(species, place, this.season),
      );
      this.stands.set(id, { trees, cards: null, age: 0, time_s: Number.NaN });
    });
  }

  private asset(id: string): TreeAsset | undefined {
    return this.assets.find((asset) => asset.id === id);
  }

  setSeason(season: Season): void {
    if (season === this.season) return;
    this.season = season;
    for (const [id, { trees }] of this.stands) {
      const species = this.asset(id)?.species ?? null;
      trees.setTints((place) => leafTint(species, place, season));
    }
  }

  /** Selects the trees of this view; call when the camera has moved or another atlas is complete. */
  select(view: View): void {
    for (const [id, stand] of this.stands) {
      const model = this.asset(id)?.model;
      const atlas = model ? this.library.atlasOf(model) : null;
      if (!atlas) {
        stand.cards?.hide();
        continue;
      }
      if (stand.cards?.atlas !== atlas) {
        stand.cards?.dispose();
        stand.cards = new Cards(atlas, null);
        stand.cards.addTo(this.group);
      }
      stand.trees.select(stand.cards, view);
    }
  }

  /** Per frame: moves the trees in the wind that moves the simulated ones, up to the time of their poses. */
  advance(wind: WindState, time_s: number): void {
    if (time_s === this.time_s) return;
    this.time_s = time_s;
    this.field ??= new WindField(wind);
    this.field.state = wind;
    this.frame++;
    let turn = 0;
    for (const [id, stand] of this.stands) {
      const motion = this.asset(id)?.motion;
      stand.age++;
      if (motion && (this.frame + turn++) % POSE_PERIOD_FRAMES === 0) {
        const dt_s = Math.min(LONGEST_S, Math.max(0, time_s - (stand.time_s || time_s)));
        stand.trees.advance(dt_s, time_s, this.field, motion, stand.cards);
        stand.time_s = time_s;
        stand.age = 1;
      }
      if (stand.cards) stand.cards.uniforms.uShare.value = Math.min(1, stand.age / POSE_PERIOD_FRAMES);
    }
  }

  /** All background trees: x, z, height, crown radius, packed. */
  get shading(): number[] {
    return [...this.stands].flatMap(([id, { trees }]) => {
      const model = this.asset(id)?.model;
      return model ? trees.shading(model.height_m, model.radius_m) : [];
    });
  }

  get count(): number {
    return [...this.stands.values()].reduce((sum, { trees }) => sum + trees.count, 0);
  }

  private clear(): void {
    for (const { cards } of this.stands.values()) cards?.dispose();
    this.stands.clear();
  }

  dispose(): void {
    this.clear();
  }
}
