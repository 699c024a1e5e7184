/** Camera views, the fly-through and the way to a tree. */

import { signal } from "@preact/signals-core";
import { CameraFlight } from "../../scene/camera/cameraFlight";
import { treeView } from "../../scene/camera/treeView";
import { type Subject, VIEWS, type ViewName, viewpoint } from "../../scene/camera/viewpoints";
import { toggle, tool } from "../controls/tools";
import type { Frame } from "../forest/frameLoop";
import type { World } from "../forest/world";
import type { Store } from "../store/store";
import { make, makeButton, prefersCalm } from "../ui/dom";

/** The camera is not taken out of hands that have moved it this long ago. */
const AFTERWARDS_MS = 4000;

export class Views {
  readonly tools: HTMLElement[];
  private readonly flight: CameraFlight;
  private readonly flying = signal(false);
  private held = false;
  private touched_ms = Number.NEGATIVE_INFINITY;

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    const { camera, controls } = world.stage;
    this.flight = new CameraFlight(camera, controls, () => {
      this.flying.value = false;
    });
    this.tools = [
      ...this.menu(),
      toggle(
        "fly",
        "Fly through the forest",
        () => this.flying.value,
        () => this.fly(),
      ),
    ];
    this.followHands();
  }

  /** Notes when the visitor moves the camera. */
  private followHands(): void {
    const { canvas } = this.world;
    const touched = () => {
      this.touched_ms = performance.now();
    };
    canvas.addEventListener("pointerdown", () => {
      this.held = true;
    });
    for (const name of ["wheel", "keydown"]) canvas.addEventListener(name, touched, { passive: true });
    for (const name of ["pointerup", "pointercancel"])
      addEventListener(name, () => {
        if (this.held) touched();
        this.held = false;
      });
  }

  /** The button and its menu. */
  private menu(): HTMLElement[] {
    const menu = make("div", "", "views-menu");
    const opener = tool("views", "Views", () => open(menu.hidden === true));
    const open = (visible: boolean) => {
      menu.hidden = !visible;
      opener.setAttribute("aria-expanded", String(visible));
    };
    menu.id = "views-menu";
    opener.setAttribute("aria-controls", menu.id);
    open(false);
    for (const name of Object.keys(VIEWS) as ViewName[]) {
      const choose = () => {
        open(false);
        this.view(name);
      };
      menu.append(makeButton(VIEWS[name], choose));
    }
    addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || menu.hidden) return;
      open(false);
      opener.focus();
    });
    addEventListener("pointerdown", ({ target }) => {
      if (!(target instanceof Element) || !target.closest("#tools")) open(false);
    });
    return [opener, menu];
  }

  private view(name: ViewName): void {
    const { towardsSun } = this.world.stage.daylight;
    this.flight.go(viewpoint(name, this.subjects(), towardsSun), prefersCalm());
  }

  private fly(): void {
    if (this.flight.flying) this.flight.land();
    else this.flight.fly();
    this.flying.value = this.flight.flying;
  }

  /** Whether the camera is under way by itself, in the visitor's hands, or recorded. */
  get isBusy(): boolean {
    const recent = performance.now() - this.touched_ms < AFTERWARDS_MS;
    return this.flight.flying || this.store.state.filming || this.held || recent;
  }

  /** Moves the camera to a tree. */
  showTree(tree: Subject): void {
    const { camera, daylight } = this.world.stage;
    this.flight.go(treeView(tree, this.subjects(), daylight.towardsSun, camera.aspect), prefersCalm());
  }

  private subjects(): Subject[] {
    return this.world.forest.moving.flatMap(({ forest: { instances, model } }) =>
      Array.from({ length: instances.count }, (_, tree) => ({
        x: instances.placement[tree * 4],
        z: instances.placement[tree * 4 + 1],
        height_m: model.height_m * instances.placement[tree * 4 + 3],
      })),
    );
  }

  advance({ passed_s }: Frame): void {
    this.flight.advance(passed_s);
  }
}
