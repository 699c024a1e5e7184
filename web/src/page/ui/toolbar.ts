/** The toolbar: pause, undo, camera views, tree physics, accuracy check, sharing, sound, photo, video, full screen. */
import { VIEWS, type ViewName } from "../../scene/camera/viewpoints";
import { element, make } from "./dom";
import { type IconName, icon } from "./icons";

export interface Tools {
  /** Pauses the motion, or lets it go on. */
  pause(): void;
  undo(): void;
  redo(): void;
  view(name: ViewName): void;
  /** Starts or stops the fly-through; returns whether it is running. */
  fly(): boolean;
  /** Makes the forest a shared one and copies its link. */
  share(): void;
  link(): void;
  /** Shows the code that embeds the forest in another page. */
  embed(): void;
  /** Turns the sound of the wind on or off; returns whether it is on. */
  sound(): boolean;
  photo(): void;
  /** Starts or stops recording; returns whether it is recording. */
  film(): boolean;
  physics(): void;
  /** Opens the comparison of a tree with the reference solution. */
  compare(): void;
}

export class Toolbar {
  private readonly pause: HTMLButtonElement;
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;
  private readonly fly: HTMLButtonElement;
  private readonly film: HTMLButtonElement;
  private readonly menu = make("div", "", "views-menu");
  private readonly life = new AbortController();

  constructor(tools: Tools, can: { film: boolean; fullScreen: boolean }) {
    const bar = element("tools");
    const views = tool("views", "Views");
    views.setAttribute("aria-expanded", "false");
    views.setAttribute("aria-controls", "views-menu");
    views.addEventListener("click", () => this.openMenu(this.menu.hidden === true, views));
    this.fillMenu(tools, views);
    this.pause = button("pause", "Pause the motion (Space)", () => tools.pause());
    this.pause.setAttribute("aria-pressed", "false");
    this.undo = button("undo", "Undo (Ctrl+Z)", () => tools.undo());
    this.redo = button("redo", "Redo (Ctrl+Y)", () => tools.redo());
    this.showUndo(false, false);
    this.fly = toggle("fly", "Fly through the forest", () => tools.fly());
    this.film = toggle("film", "Record video", () => tools.film());
    this.film.hidden = !can.film;
    const full = tool("full", "Full screen");
    full.hidden = !can.fullScreen;
    full.addEventListener("click", () => void switchFullScreen());
    element("playback").replaceChildren(this.pause);
    bar.replaceChildren(
      this.undo,
      this.redo,
      views,
      this.menu,
      this.fly,
      button("trees", "Tree physics", () => tools.physics()),
      button("compare", "Check accuracy", () => tools.compare()),
      button("share", "Share this forest", () => tools.share()),
      button("link", "Copy link", () => tools.link()),
      button("embed", "Embed code", () => tools.embed()),
      toggle("sound", "Sound of the wind", () => tools.sound()),
      button("photo", "Save photo", () => tools.photo()),
      this.film,
      full,
    );
  }

  private fillMenu(tools: Tools, opener: HTMLButtonElement): void {
    this.menu.id = "views-menu";
    this.menu.hidden = true;
    this.menu.append(
      ...(Object.keys(VIEWS) as ViewName[]).map((name) => {
        const item = make("button", VIEWS[name]);
        item.type = "button";
        item.addEventListener("click", () => {
          this.openMenu(false, opener);
          tools.view(name);
        });
        return item;
      }),
    );
    const { signal } = this.life;
    addEventListener(
      "keydown",
      (event) => {
        if (event.key !== "Escape" || this.menu.hidden) return;
        this.openMenu(false, opener);
        opener.focus();
      },
      { signal },
    );
    addEventListener(
      "pointerdown",
      (event) => {
        if (!(event.target instanceof Element) || !event.target.closest("#tools"))
          this.openMenu(false, opener);
      },
      { signal },
    );
  }

  private openMenu(open: boolean, opener: HTMLButtonElement): void {
    this.menu.hidden = !open;
    opener.setAttribute("aria-expanded", String(open));
  }

  showPause(paused: boolean): void {
    this.pause.setAttribute("aria-pressed", String(paused));
  }

  /** Enables what is possible. */
  showUndo(undo: boolean, redo: boolean): void {
    this.undo.disabled = !undo;
    this.redo.disabled = !redo;
  }

  showFlight(flying: boolean): void {
    this.fly.setAttribute("aria-pressed", String(flying));
  }

  showFilm(filming: boolean): void {
    this.film.setAttribute("aria-pressed", String(filming));
  }

  dispose(): void {
    this.life.abort();
  }
}

async function switchFullScreen(): Promise<void> {
  if (document.fullscreenElement) await document.exitFullscreen();
  else await document.documentElement.requestFullscreen();
}

function tool(name: IconName, words: string): HTMLButtonElement {
  const made = make("button", "", "tool");
  made.type = "button";
  made.title = words;
  made.setAttribute("aria-label", words);
  made.append(icon(name), make("span", words));
  return made;
}

function button(name: IconName, words: string, pressed: () => void): HTMLButtonElement {
  const made = tool(name, words);
  made.addEventListener("click", pressed);
  return made;
}

function toggle(name: IconName, words: string, flip: () => boolean): HTMLButtonElement {
  const made = tool(name, words);
  made.setAttribute("aria-pressed", "false");
  made.addEventListener("click", () => made.setAttribute("aria-pressed", String(flip())));
  return made;
}
