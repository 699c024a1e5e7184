/** Everything beyond the simulated trees: impostors of trees, the canopy seen from afar, and shadows of trees on distant ground. */

import type { View } from "galewood/trees";
import type { Texture, WebGLRenderer } from "three";
import type { TreeAsset } from "../forest";
import { shared } from "../impostors/cardMaterial";
import { castShade, groundShade } from "../impostors/groundShade";
import { ImpostorLibrary } from "../impostors/library";
import { SHADER_FLOATS } from "../impostors/shadeMap";
import type { Quality } from "../quality";
import type { Season } from "../season/season";
import type { Daylight } from "../sky/daylight";
import { CROWN_FLOATS, type Crowns } from "../sky/exposure";
import { Canopy, canopyFrom_m } from "./canopy";
import { FarWood, type Planted } from "./farWood";

/** Distance from which simulated trees of scale 1 are drawn as impostors. */
const CARDS_FROM_M: Record<Quality, number> = { low: 45, medium: 85, high: 120 };
/** Side of the picture from which each view of an impostor is reduced, px. */
const BAKED_PX: Record<Quality, number> = { low: 256, medium: 512, high: 512 };
/** Frames that are drawn before the background is planted, so that it does not delay the first moving tree. */
const HEAD_START = 2;
/** Light that a bare crown holds back, relative to one in leaf. */
const BARE_SHADE = 0.35;
/** While the sun moves, the shadows on distant ground are renewed at most this often. */
const SHADE_EVERY_MS = 300;

/** Height of the trees without their known models, m. */
const USUAL_HEIGHT_M = 16;

/** Mean height of the built-in trees in the forest, m. */
function crownHeight_m(assets: readonly TreeAsset[]): number {
  const grown = assets.filter(({ builtin, form, model }) => builtin && form === "forest" && model);
  if (grown.length === 0) return USUAL_HEIGHT_M;
  return grown.reduce((sum, { model }) => sum + (model?.height_m ?? 0), 0) / grown.length;
}

export class Backdrop {
  readonly library: ImpostorLibrary;
  readonly wood: FarWood;
  readonly canopy: Canopy;
  private changed = false;
  private crowns: Crowns = new Float32Array(0);
  private shadeOutdated = false;
  private shaded_ms = 0;
  /** Frames since the last change. */
  private quiet = 0;
  /** What the background must be planted around, and the frames drawn since then. */
  private planted: Planted | null = null;
  private drawn = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly daylight: Daylight,
    private quality: Quality,
    noise: Texture,
  ) {
    this.canopy = new Canopy(noise);
    this.library = new ImpostorLibrary(BAKED_PX[quality]);
    this.wood = new FarWood(this.library);
    this.setQuality(quality);
    canvas.addEventListener("webglcontextrestored", this.renew);
  }

  /** Whether there are distant trees; from the next planting on. */
  shown = true;

  setQuality(quality: Quality): void {
    this.quality = quality;
    this.library.setDetail(BAKED_PX[quality]);
    this.library.from_m = CARDS_FROM_M[quality];
    this.canopy.setQuality(quality);
  }

  /** Colours, leaves and shadows of a season and time of day. */
  setSeason(season: Season): void {
    const bare = season === "winter";
    shared.uBare.value = bare ? 1 : 0;
    this.library.setLeafless(bare);
    this.wood.setSeason(season);
    this.canopy.setSeason(season);
    this.shadeOutdated = true;
    this.changed = true;
  }

  /** Plants the background around the simulated trees, after these have been drawn. */
  surround(planted: Planted): void {
    this.planted = planted;
    this.drawn = 0;
  }

  private plant(planted: Planted): void {
    const assets = this.shown ? planted.assets : [];
    const models = assets.filter(({ model }) => model !== null);
    models.sort((a, b) => Number(b.builtin) - Number(a.builtin));
    this.library.keep(models.flatMap(({ model }) => model ?? []));
    this.wood.populate({ ...planted, assets }, this.quality);
    this.canopy.spread(canopyFrom_m(planted.edge_m, this.shown), crownHeight_m(planted.assets));
    this.shadeOutdated = true;
    this.changed = true;
  }

  /** Where the simulated trees stand. */
  shelter(crowns: Crowns): void {
    this.crowns = crowns;
    this.shadeOutdated = true;
  }

  private readonly renew = (): void => {
    this.library.renew();
    this.shadeOutdated = true;
    this.changed = true;
  };

  /** Whether trees must be selected again although the camera stands still; call once per frame. */
  takeChange(): boolean {
    const changed = this.changed || this.library.arriving;
    this.changed = false;
    this.library.arriving = false;
    return changed;
  }

  /** Selects the background trees of the current view. */
  select(view: View): void {
    this.wood.select(view);
  }

  /** Per frame, before drawing: bakes some views, and renews outdated shadows. */
  prepare(renderer: WebGLRenderer): void {
    if (this.planted && this.drawn++ >= HEAD_START) {
      this.plant(this.planted);
      this.planted = null;
    }
    this.shadeGround();
    if (this.library.work(renderer)) {
      this.shadeOutdated = true;
      this.changed = true;
    }
    const baking = this.shown && !this.library.isReady;
    const busy = this.planted || baking || this.library.arriving || this.changed || this.shadeOutdated;
    this.quiet = busy ? 0 : this.quiet + 1;
  }

  private shadeGround(): void {
    const now_ms = performance.now();
    const reach_m = this.daylight.shadowReach_m;
    groundShade.uShadeFrom.value.set(0.75 * reach_m, reach_m, shared.uBare.value > 0 ? BARE_SHADE : 1);
    if (!this.shadeOutdated || now_ms - this.shaded_ms < SHADE_EVERY_MS) return;
    this.shadeOutdated = false;
    this.shaded_ms = now_ms;
    castShade(Float32Array.from([...this.simulated(), ...this.wood.shading]), this.daylight.towardsSun);
  }

  /** x, z, height and crown radius of the simulated trees. */
  private simulated(): number[] {
    const { crowns } = this;
    const out: number[] = new Array((crowns.length / CROWN_FLOATS) * SHADER_FLOATS);
    for (let at = 0, to = 0; at < crowns.length; at += CROWN_FLOATS) {
      out[to++] = crowns[at];
      out[to++] = crowns[at + 2];
      out[to++] = 2.7 * crowns[at + 4];
      out[to++] = crowns[at + 3];
    }
    return out;
  }

  /** Whether all impostors are baked and in place, and the number of background trees. */
  get figures(): { ready: boolean; backgroundTrees: number } {
    return { ready: this.quiet > 1, backgroundTrees: this.wood.count };
  }

  dispose(): void {
    this.canvas.removeEventListener("webglcontextrestored", this.renew);
    this.wood.dispose();
    this.canopy.dispose();
    this.library.dispose();
  }
}
