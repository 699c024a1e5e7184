/** `window.galewood`: the API for tests and embedding pages. */

import type { WindDocument } from "galewood/wind";
import type { App } from "./app";
import type { PickedFigures } from "./treePicker";

export interface Probe {
  readonly frame: number;
  readonly time_s: number;
  readonly readySpecies: string[];
  readonly trees: { moving: number; still: number };
  /** Number of trees of an upload or of a form of a species, by its id on the server. */
  planted(treeId: string): number;
  /** Number of trees that move by the paper's state search. */
  readonly paperTrees: number;
  /** Number of trees that move by a table without leaves. */
  readonly bareTrees: number;
  readonly crownDisplacement_m: [number, number, number];
  readonly lookup: "worker" | "server";
  readonly connection: App["connection"];
  readonly paused: boolean;
  readonly wind: WindDocument;
  /** Share of the trees within the sampled range of winds, 0..1. */
  readonly coverage: number;
  /** The anemometer; null if none is placed. */
  readonly anemometer: App["studio"]["anemometer"];
  /** Sets the wind from a document; throws an error that names the invalid field. */
  setWind(document: unknown): void;
  pause(): void;
  resume(): void;
  look: App["look"];
  /** Position of the camera, m. */
  readonly eye: readonly [number, number, number];
  /** A URL that restores this forest, wind, light and view. */
  readonly link: string;
  /** Sets season ("spring", "summer", "autumn", "winter") and elapsed share of the daylight. */
  dress: App["setScenery"];
  /** Stops advancing and drawing, or resumes. */
  sleep(asleep: boolean): void;
  /** Advances by one frame of dt_s and waits for it; for frame-by-frame rendering while asleep. */
  step(dt_s: number, drawn?: boolean): Promise<void>;
  /** Picks the tree at a position in the window (px), as a click does; null if there is none. */
  pick(left_px: number, top_px: number): PickedFigures | null;
  /** The picked tree and its current figures. */
  readonly picked: PickedFigures | null;
  /** What is drawn on the picked tree. */
  readonly overlay: App["overlays"]["shown"];
  /** Loudness of the wind, 0..1. */
  readonly loudness: number;
  /** The branch that this visitor pulls: its tree, where point and hand are in the window, displacement and force. */
  readonly pull: App["puller"]["figures"];
  /** The trees that are pulled or ring down, by anyone. */
  readonly pulled: App["pulled"];
  /** Whether the camera keeps the picked tree in the middle. */
  follow(following: boolean): void;
  /** Cost of the page: frame, script and worker times, triangles. */
  readonly statistics: App["figures"]["statistics"] & {
    readonly impostors: App["stage"]["backdrop"]["figures"];
  };
  /** Draws the trees as static instances, or moving again, to measure the cost of the motion. */
  freeze(frozen: boolean): void;
}

declare global {
  interface Window {
    galewood?: Probe;
  }
}

export function exposeProbe(app: App): void {
  window.galewood = {
    get frame() {
      return app.loop.frame;
    },
    get time_s() {
      return app.figures.time_s;
    },
    get readySpecies() {
      return app.figures.readySpecies;
    },
    get trees() {
      return app.figures.trees;
    },
    planted: (treeId) => app.figures.planted(treeId),
    get paperTrees() {
      return app.figures.paperTrees;
    },
    get bareTrees() {
      return app.figures.bareTrees;
    },
    get crownDisplacement_m() {
      return app.figures.crownDisplacement_m;
    },
    get lookup() {
      return app.settings.lookup;
    },
    get connection() {
      return app.connection;
    },
    get paused() {
      return app.loop.paused;
    },
    get wind() {
      return app.settings.wind;
    },
    get coverage() {
      return app.studio.coverage;
    },
    get anemometer() {
      return app.studio.anemometer;
    },
    setWind: (document) => app.setWind(document),
    pause() {
      app.loop.paused = true;
    },
    resume() {
      app.loop.paused = false;
    },
    look: (eye, at) => app.look(eye, at),
    get eye() {
      return app.visit.moment.eye;
    },
    get link() {
      return app.visit.link;
    },
    dress: (season, daytime) => app.setScenery(season, daytime),
    sleep(asleep) {
      app.loop.asleep = asleep;
    },
    step: (dt_s, drawn) => app.loop.step(dt_s, drawn),
    pick(left_px, top_px) {
      app.picker.select(app.picker.find(left_px, top_px));
      return app.picker.figures;
    },
    get picked() {
      return app.picker.figures;
    },
    get overlay() {
      return app.overlays.shown;
    },
    get loudness() {
      return app.sound.loudness;
    },
    get pull() {
      return app.puller.figures;
    },
    get pulled() {
      return app.pulled;
    },
    follow(following) {
      app.picker.following = following;
    },
    get statistics() {
      return { ...app.figures.statistics, impostors: app.stage.backdrop.figures };
    },
    freeze: (frozen) => app.freeze(frozen),
  };
}
