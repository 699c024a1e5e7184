/** The settings panel. */

import { type PlainWind, withinTurn, withPlain } from "galewood/wind";
import { type BladeApi, type FolderApi, Pane } from "tweakpane";
import type { Statistics } from "../frameStatistics";
import { type Playback, SPEEDS } from "../playback";
import { type Planted, plantedAs } from "../settings/planted";
import { LIMITS, type Settings } from "../settings/settings";
import { WIND_LIMITS } from "../settings/windQuery";
import { labelInputs } from "./accessible";
import { element, make } from "./dom";
import { bearingFrom_deg, directionFrom_deg } from "./instruments/beaufort";
import { UploadList } from "./uploadList";

export type SettingKey = keyof Settings;

const whole = (value: number) => Math.round(value).toLocaleString("en");
const fine = (value: number) => value.toFixed(1);

export class Panel {
  private readonly pane: Pane;
  private readonly species: FolderApi;
  readonly uploads: UploadList;
  private readonly changed: (key: SettingKey) => void;
  /** What keeps trees from using the chosen method. */
  private readonly methodNote = make("p", "", "method-note");
  private shownSpecies = "";
  /** True during refresh(): Tweakpane reports a refresh as a change, with values clamped to the slider limits. */
  private refreshing = false;
  private showEasing = () => {};

  constructor(
    private readonly settings: Settings,
    private readonly statistics: Statistics,
    playback: Playback,
    sound: { volume: number },
    onChange: (key: SettingKey) => void,
    plant: (id: string, how: Planted | null) => void,
  ) {
    this.changed = (key) => {
      if (!this.refreshing) onChange(key);
    };
    this.pane = new Pane({ container: element("panel") });
    this.wind(this.pane.addFolder({ title: "Wind" }));
    this.forest(this.pane.addFolder({ title: "Forest" }));
    this.species = this.pane.addFolder({ title: "Species mix", expanded: false });
    this.uploads = new UploadList(
      this.pane.addFolder({ title: "Uploaded trees", expanded: false }),
      (id) => plantedAs(settings, id),
      plant,
      () => labelInputs(element("panel")),
    );
    const motion = this.pane.addFolder({ title: "Motion" });
    motion.addBinding(playback, "speed", { label: "Speed", options: SPEEDS });
    this.number(motion, "exaggeration", "Exaggeration", (value) => `×${value.toFixed(1)}`, false);
    motion.addButton({ title: "Pause, and one step on" }).on("click", () => playback.step());
    this.lookup(motion);
    const loud = this.pane.addFolder({ title: "Sound", expanded: false });
    loud.addBinding(sound, "volume", { label: "Volume", min: 0, max: 1, step: 0.05 });
    this.figures(this.pane.addFolder({ title: "Statistics", expanded: false }));
    labelInputs(element("panel"));
  }

  /** `released`: the change counts only once the slider is released. */
  private number(
    folder: FolderApi,
    key: keyof typeof LIMITS,
    label: string,
    format = whole,
    released = true,
  ): void {
    folder
      .addBinding(this.settings as Settings & { poseEasing: number }, key, { label, format, ...LIMITS[key] })
      .on("change", ({ last }) => {
        if (last || !released) this.changed(key); // trees are placed again only when the slider is released
      });
  }

  /** A number of the wind document; changes apply immediately. */
  private windNumber(
    folder: FolderApi,
    key: keyof PlainWind,
    label: string,
    format = whole,
    { shown, meant } = { shown: (value: number) => value, meant: (value: number) => value },
  ): void {
    const { settings } = this;
    const choose = (value: number) => {
      if (!this.refreshing) settings.wind = withPlain(settings.wind, { [key]: value });
    };
    const bound = {
      get value() {
        return shown(withinTurn(settings.wind)[key]);
      },
      set value(value) {
        choose(meant(value));
      },
    };
    folder
      .addBinding(bound, "value", { label, format, ...WIND_LIMITS[key] })
      .on("change", () => this.changed("wind"));
  }

  private wind(folder: FolderApi): void {
    this.windNumber(folder, "mean_speed_m_s", "Mean speed (m/s)", fine);
    this.windNumber(folder, "direction_deg", "From (90° = east)", whole, {
      shown: bearingFrom_deg,
      meant: directionFrom_deg,
    });
    this.windNumber(folder, "gustiness", "Gustiness", (value) => value.toFixed(2));
    this.windNumber(folder, "seed", "Gust seed");
    this.choice(folder, "flutter", "Leaf flutter");
  }

  private forest(folder: FolderApi): void {
    this.number(folder, "trees", "Number of trees");
    this.number(folder, "density", "Density", (value) => value.toFixed(2));
    this.number(folder, "forestSeed", "Placement seed");
    this.choice(folder, "form", "Tree form", {
      "By place": "place",
      "Open-grown": "open",
      "Forest-grown": "forest",
    });
    this.choice(folder, "background", "Distant forest");
    this.choice(folder, "quality", "Render quality", { Low: "low", Medium: "medium", High: "high" });
    this.choice(folder, "frameRateLimit_hz", "Frame rate", {
      "As the display": LIMITS.frameRateLimit_hz.max,
      "At most 30": 30,
      "At most 15": 15,
    });
  }

  private lookup(folder: FolderApi): void {
    this.choice(folder, "lookup", "Computed", { "In this browser": "worker", "On the server": "server" });
    const method = this.choice(folder, "method", "Method", {
      "Modal reduced order": "modal",
      "Paper's state search": "paper",
    });
    const advanced = folder.addFolder({ title: "Advanced", expanded: false });
    method.element.after(this.methodNote);
    this.methodNote.hidden = true;
    const { settings } = this;
    const easing = {
      get own() {
        return settings.poseEasing !== null;
      },
      set own(own: boolean) {
        if (own !== this.own) settings.poseEasing = own ? 0.05 : null;
      },
    };
    let slider: BladeApi | null = null;
    this.showEasing = () => {
      if (easing.own === (slider !== null)) return;
      if (slider) advanced.remove(slider);
      slider = easing.own ? this.easingSlider(advanced) : null;
      labelInputs(element("panel"));
    };
    advanced.addBinding(easing, "own", { label: "Custom easing" }).on("change", () => {
      this.showEasing();
      this.changed("poseEasing");
    });
    this.showEasing();
  }

  private easingSlider(folder: FolderApi): BladeApi {
    return folder
      .addBinding(this.settings as Settings & { poseEasing: number }, "poseEasing", {
        label: "Pose easing",
        format: (value: number) => value.toFixed(3),
        ...LIMITS.poseEasing,
      })
      .on("change", () => this.changed("poseEasing"));
  }

  private choice(
    folder: FolderApi,
    key: "background" | "flutter" | "form" | "frameRateLimit_hz" | "quality" | "lookup" | "method",
    label: string,
    options?: Record<string, string | number>,
  ): BladeApi {
    return folder
      .addBinding(this.settings, key, options ? { label, options } : { label })
      .on("change", () => this.changed(key));
  }

  /** Shows a text below the choice of method; an empty one hides it. */
  showMethodNote(words: string): void {
    if (this.methodNote.textContent === words) return;
    this.methodNote.textContent = words;
    this.methodNote.hidden = words === "";
  }

  private figures(folder: FolderApi): void {
    const show = (key: keyof Statistics, label: string, format?: (value: number) => string) =>
      folder.addBinding(this.statistics, key, {
        readonly: true,
        label,
        interval: 500,
        ...(format && { format }),
      });
    folder.addBinding(this.statistics, "framesPerSecond", {
      readonly: true,
      label: "Frame rate (1/s)",
      view: "graph",
      min: 0,
      max: 75,
      interval: 250,
    });
    show("frame_ms", "Frame time (ms)", fine);
    show("script_ms", "Script time (ms)", fine);
    show("lookup_ms", "Worker time (ms)", fine);
    show("trees", "Moving trees", whole);
    show("triangles", "Triangles", whole);
    show("drawCalls", "Draw calls", whole);
    show("stream", "Stream rate");
    show("latency", "Latency");
    show("frameAge", "Frame age");
  }

  /** One slider per species: its relative frequency in the forest. */
  showSpecies(species: readonly { id: string; name: string }[]): void {
    const key = JSON.stringify(species);
    if (key === this.shownSpecies) return;
    this.shownSpecies = key;
    for (const child of [...this.species.children]) this.species.remove(child);
    for (const { id, name } of species) {
      const share = { value: this.settings.shares[id] ?? 1 };
      this.species
        .addBinding(share, "value", { label: name, min: 0, max: 1, step: 0.05, format: (v) => v.toFixed(2) })
        .on("change", ({ last, value }) => {
          this.settings.shares[id] = value;
          if (last) this.changed("shares");
        });
    }
    labelInputs(element("panel"));
  }

  /** Shows settings that were replaced, also the shares of the species. */
  showReplaced(): void {
    this.shownSpecies = "";
    this.refresh();
  }

  /** Shows settings that were changed elsewhere. */
  refresh(): void {
    this.refreshing = true;
    this.showEasing();
    this.pane.refresh();
    this.refreshing = false;
  }

  dispose(): void {
    this.pane.dispose();
  }
}
