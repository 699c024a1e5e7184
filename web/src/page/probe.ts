/** `window.galewood`: the API for tests and embedding pages. */

import { parseWind, type WindDocument } from "galewood/wind";
import type { Season } from "../scene/season/season";
import { DAYTIMES } from "../scene/sky/daytime";
import type { Page } from "./app";
import type { PickedFigures } from "./picking/treePicker";
import { clampTo } from "./settings/queryNumbers";

interface Probe {
  readonly frame: number;
  readonly time_s: number;
  readonly readySpecies: string[];
  readonly trees: { moving: number; still: number };
  /** Whether all trees are loaded and planted. */
  readonly allPlanted: boolean;
  /** Number of trees of an upload or of a form of a species, by its id on the server. */
  planted(treeId: string): number;
  /** Number of trees that move by the paper's state search. */
  readonly paperTrees: number;
  /** Number of trees that move by a table without leaves. */
  readonly bareTrees: number;
  readonly crownDisplacement_m: [number, number, number];
  readonly lookup: "worker" | "server";
  readonly connection: Page["world"]["client"]["connection"] & { readonly events: boolean };
  readonly paused: boolean;
  readonly wind: WindDocument;
  /** Share of the trees within the sampled range of winds, 0..1. */
  readonly coverage: number;
  /** The anemometer; null if none is placed. */
  readonly anemometer: Page["studio"]["anemometer"];
  /** Sets the wind from a document; throws an error that names the invalid field. */
  setWind(document: unknown): void;
  pause(): void;
  resume(): void;
  look: Page["world"]["look"];
  /** Position of the camera, m. */
  readonly eye: readonly [number, number, number];
  /** A URL that restores this forest, wind, light and view. */
  readonly link: string;
  /** Sets season ("spring", "summer", "autumn", "winter") and elapsed share of the daylight (beyond 0..1: night). */
  dress(season: Season, daytime: number): void;
  /** Stops advancing and drawing, or resumes. */
  sleep(asleep: boolean): void;
  /** Advances by one frame of dt_s and waits for it; for frame-by-frame rendering while asleep. */
  step(dt_s: number, drawn?: boolean): Promise<void>;
  /** Picks the tree at a position in the window (px), as a click does; null if there is none. */
  pick(left_px: number, top_px: number): PickedFigures | null;
  /** The picked tree and its current figures. */
  readonly picked: PickedFigures | null;
  /** What is drawn on the picked tree. */
  readonly overlay: Page["overlays"]["shown"];
  /** Loudness of the wind, 0..1. */
  readonly loudness: number;
  /** The branch that this visitor pulls: its tree, where point and hand are in the window, displacement and force. */
  readonly pull: Page["puller"]["figures"];
  /** The trees that are pulled or ring down, by anyone. */
  readonly pulled: Page["world"]["client"]["pulled"];
  /** Whether the camera keeps the picked tree in the middle. */
  follow(following: boolean): void;
  /** Cost of the page: frame, script and worker times, triangles. */
  readonly statistics: Page["figures"]["statistics"] & {
    readonly impostors: Page["world"]["stage"]["backdrop"]["figures"];
  };
  /** Draws the trees as static instances, or moving again, to measure the cost of the motion. */
  freeze(frozen: boolean): void;
}

declare global {
  interface Window {
    galewood?: Probe;
  }
}

export function exposeProbe(page: Page): void {
  const { store, world, loop, figures, studio, sharing, picker, puller, overlays, sound } = page;
  const { settings, state } = store;
  window.galewood = {
    get frame() {
      return loop.frame;
    },
    get time_s() {
      return figures.time_s;
    },
    get readySpecies() {
      return figures.readySpecies;
    },
    get trees() {
      return figures.trees;
    },
    get allPlanted() {
      return figures.allPlanted;
    },
    planted: (treeId) => figures.planted(treeId),
    get paperTrees() {
      return figures.paperTrees;
    },
    get bareTrees() {
      return figures.bareTrees;
    },
    get crownDisplacement_m() {
      return figures.crownDisplacement_m;
    },
    get lookup() {
      return settings.lookup;
    },
    get connection() {
      return { ...world.client.connection, events: state.connected };
    },
    get paused() {
      return state.stopped;
    },
    get wind() {
      return settings.wind;
    },
    get coverage() {
      return studio.coverage;
    },
    get anemometer() {
      return studio.anemometer;
    },
    setWind(document) {
      settings.wind = parseWind(document);
    },
    pause: () => world.pause(true),
    resume: () => world.pause(false),
    look: (eye, at) => world.look(eye, at),
    get eye() {
      return sharing.moment.eye;
    },
    get link() {
      return sharing.link;
    },
    dress: (season, daytime) => store.change({ season, daytime: clampTo(DAYTIMES, daytime) }),
    sleep(asleep) {
      state.asleep = asleep;
    },
    step: (dt_s, drawn) => loop.step(dt_s, drawn),
    pick(left_px, top_px) {
      picker.select(world.pick(left_px, top_px));
      return picker.figures;
    },
    get picked() {
      return picker.figures;
    },
    get overlay() {
      return overlays.shown;
    },
    get loudness() {
      return sound.loudness;
    },
    get pull() {
      return puller.figures;
    },
    get pulled() {
      return world.client.pulled;
    },
    follow(following) {
      picker.following.value = following;
    },
    get statistics() {
      return { ...figures.statistics, impostors: world.stage.backdrop.figures };
    },
    freeze: (frozen) => world.forest.freeze(frozen),
  };
}
