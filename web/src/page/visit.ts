/** The toolbar's actions: camera views, fly-through, link, photo, video, tree physics. */

import { CameraFlight } from "../scene/camera/cameraFlight";
import { treeView } from "../scene/camera/treeView";
import { type Subject, type ViewName, viewpoint } from "../scene/camera/viewpoints";
import type { Forest } from "../scene/forest";
import type { Stage } from "../scene/stage";
import { canFilm, Film, LONGEST_FILM_S, savePhoto } from "./capture";
import type { Playback } from "./playback";
import type { Catalogue } from "./server/catalogue";
import { type Moment, momentFrom, shareQuery } from "./settings/link";
import type { Settings } from "./settings/settings";
import { sharedFrom, withShared } from "./settings/sharedForest";
import { Sharing } from "./sharing";
import type { WindSound } from "./sound";
import { EmbedBar } from "./ui/embedBar";
import { PhysicsCards } from "./ui/physicsCards";
import { showToast } from "./ui/toast";
import { Toolbar } from "./ui/toolbar";
import { Undo, type UndoEvents } from "./undo";

const CALM = "The motion is paused.";
const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/** What the tools change elsewhere on the page. */
export interface VisitPage {
  /** Settings were replaced by undo or redo. */
  readonly replaced: UndoEvents["replaced"];
  /** Id of the shared forest; null while the forest is private. */
  share(): string | null;
  /** Returns whether the forest is shared from now on. */
  startSharing(id: string): boolean;
}

/** The address of the whole page, given that of an embedded one. */
function withoutEmbed(link: string): string {
  const url = new URL(link);
  for (const name of ["embed", "panel"]) url.searchParams.delete(name);
  return url.href;
}

export class Visit {
  private readonly flight: CameraFlight;
  private readonly toolbar: Toolbar;
  private readonly physics = new PhysicsCards();
  readonly undo: Undo;
  readonly sharing: Sharing;
  private readonly life = new AbortController();
  private film: Film | null = null;
  private photoWanted = false;

  constructor(
    private readonly settings: Settings,
    private readonly stage: Stage,
    private readonly forest: Forest,
    private readonly catalogue: () => Catalogue,
    private readonly clock_s: () => number,
    private readonly compare: () => void,
    private readonly playback: Playback,
    private readonly sound: WindSound,
    page: VisitPage,
  ) {
    this.flight = new CameraFlight(stage.camera, stage.controls, () => this.toolbar.showFlight(false));
    this.toolbar = new Toolbar(
      {
        pause: () => {
          playback.paused = !playback.paused;
        },
        undo: () => this.undo.undo(),
        redo: () => this.undo.redo(),
        view: (name) => this.view(name),
        fly: () => this.fly(),
        share: () => this.sharing.share(),
        link: () => void this.copyLink(),
        embed: () => this.sharing.embed(),
        sound: () => {
          sound.on = !sound.on;
          return sound.on;
        },
        photo: () => {
          this.photoWanted = true;
        },
        film: () => this.filming(),
        physics: () => this.openPhysics(),
        compare: () => this.compare(),
      },
      { film: canFilm(), fullScreen: document.fullscreenEnabled },
    );
    this.undo = new Undo(settings, {
      replaced: page.replaced,
      possible: (undo, redo) => this.toolbar.showUndo(undo, redo),
    });
    this.sharing = new Sharing({
      get share() {
        return page.share();
      },
      start: page.startSharing,
      link: () => this.link,
    });
    const bar = settings.embed
      ? new EmbedBar(
          () => {
            playback.paused = !playback.paused;
          },
          () => withoutEmbed(this.link),
        )
      : null;
    playback.onPause = (paused) => {
      this.toolbar.showPause(paused);
      bar?.show(paused);
    };
    addEventListener("keydown", (event) => this.keyDown(event), { signal: this.life.signal });
    if (calm()) {
      playback.paused = true;
      showToast(
        CALM,
        "Your system asks for reduced motion. Press the pause button or Space to let the trees sway.",
        "good",
      );
    }
  }

  /** Space pauses, unless a control has the focus. */
  private keyDown(event: KeyboardEvent): void {
    const free = event.target === document.body || event.target instanceof HTMLCanvasElement;
    if (event.key !== " " || !free || event.repeat) return;
    event.preventDefault();
    this.playback.paused = !this.playback.paused;
  }

  /** Restores camera and clouds from a link. */
  restore(query: string): void {
    const { eye, target, clouds } = momentFrom(query);
    if (eye && target) {
      this.stage.camera.position.set(...eye);
      this.stage.controls.target.set(...target);
    }
    if (clouds) this.stage.sky.drift.set(...clouds);
  }

  get moment(): Moment {
    const { camera, controls, sky } = this.stage;
    return {
      eye: camera.position.toArray(),
      target: controls.target.toArray(),
      time_s: this.clock_s(),
      clouds: sky.drift.toArray(),
    };
  }

  get link(): string {
    return `${location.origin}${location.pathname}?${withShared(shareQuery(this.settings, this.moment), sharedFrom(location.search))}`;
  }

  private async copyLink(): Promise<void> {
    const { link } = this;
    history.replaceState(null, "", link);
    try {
      await navigator.clipboard.writeText(link);
      showToast("Link copied", "It restores this forest, wind, light and view.", "good");
    } catch {
      showToast("Copy the link from the address bar", "The browser blocked access to the clipboard.", "good");
    }
  }

  view(name: ViewName): void {
    const { towardsSun } = this.stage.daylight;
    this.flight.go(viewpoint(name, this.subjects(), towardsSun), calm());
  }

  private subjects(): Subject[] {
    return this.forest.moving.flatMap(({ forest: { instances, model } }) =>
      Array.from({ length: instances.count }, (_, tree) => ({
        x: instances.placement[tree * 4],
        z: instances.placement[tree * 4 + 1],
        height_m: model.height_m * instances.placement[tree * 4 + 3],
      })),
    );
  }

  /** Whether the camera is under way by itself, or recorded. */
  get isBusy(): boolean {
    return this.flight.flying || this.film !== null;
  }

  /** Moves the camera to a tree. */
  showTree(tree: Subject): void {
    const { camera, daylight } = this.stage;
    this.flight.go(treeView(tree, this.subjects(), daylight.towardsSun, camera.aspect), calm());
  }

  private fly(): boolean {
    if (this.flight.flying) this.flight.land();
    else this.flight.fly();
    return this.flight.flying;
  }

  private filming(): boolean {
    if (this.film) this.film.stop();
    else {
      this.film = new Film(this.stage.renderer.domElement, () => this.filmEnded());
      showToast("Recording video", `Press again to stop. Recording ends after ${LONGEST_FILM_S} s.`, "good");
    }
    return this.film !== null;
  }

  private filmEnded(): void {
    this.film = null;
    this.toolbar.showFilm(false);
  }

  openPhysics(): void {
    this.physics.open(this.catalogue().known);
  }

  advance(dt_s: number): void {
    this.flight.advance(dt_s);
  }

  /** Call right after a frame was drawn. */
  drawn(): void {
    if (!this.photoWanted) return;
    this.photoWanted = false;
    savePhoto(this.stage.renderer.domElement).catch((error: unknown) =>
      showToast("The photo could not be saved.", error instanceof Error ? error.message : String(error)),
    );
  }

  dispose(): void {
    this.life.abort();
    this.undo.dispose();
    this.sharing.dispose();
    this.sound.dispose();
    this.film?.stop();
    this.toolbar.dispose();
    this.physics.dispose();
  }
}
