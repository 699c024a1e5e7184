/** The settings panel. */

import { effect } from "@preact/signals-core";
import { type PlainWind, withinTurn, withPlain } from "galewood/wind";
import { type BindingParams, type BladeApi, type FolderApi, Pane } from "tweakpane";
import type { Statistics } from "../forest/frameStatistics";
import { followSlider } from "../individuals/growthPlaces";
import type { GrowthTools } from "../individuals/growthView";
import type { PaperMethod } from "../paper/paperMethod";
import type { Catalogue } from "../server/catalogue";
import { type Planted, plantAs, plantedAs } from "../settings/planted";
import { LIMITS, type Settings } from "../settings/settings";
import { WIND_LIMITS } from "../settings/windLimits";
import { PLAYBACK_SPEEDS } from "../store/playback";
import type { Store } from "../store/store";
import { element, make } from "../ui/dom";
import { bearingFrom_deg, directionFrom_deg } from "../ui/instruments/beaufort";
import { whole } from "../ui/words";
import { labelInputs } from "./accessible";

const fine = (value: number) => value.toFixed(1);
const hundredths = (value: number) => value.toFixed(2);

const PLANTED_LABELS = {
  "Not planted": "none",
  "One in the clearing": "one",
  "Among the others": "more",
  "Only this": "only",
};

/** Trees at the end of the slider; links ask for more. */
const SLIDER_TREES = 10_000;

export class Panel {
  private readonly pane = new Pane({ container: element("panel") });
  private readonly species: FolderApi;
  private readonly uploads: FolderApi;
  /** What the folders of species and uploads list. */
  private readonly listed = new Map<FolderApi, string>();
  /** What keeps trees from using the chosen method. */
  private readonly methodNote = make("p", "", "method-note");

  constructor(
    private readonly store: Store,
    private readonly catalogue: Catalogue,
    private readonly paper: PaperMethod,
    private readonly growth: GrowthTools,
    statistics: Statistics,
  ) {
    const { pane } = this;
    this.wind(pane.addFolder({ title: "Wind" }));
    this.forest(pane.addFolder({ title: "Forest" }));
    this.species = pane.addFolder({ title: "Species mix", expanded: false });
    this.uploads = pane.addFolder({ title: "Uploaded trees", expanded: false });
    this.uploads.hidden = true;
    this.motion(pane.addFolder({ title: "Motion" }));
    const loud = pane.addFolder({ title: "Sound", expanded: false });
    loud.addBinding(store.state, "volume", { label: "Volume", min: 0, max: 1, step: 0.05 });
    figures(pane.addFolder({ title: "Statistics", expanded: false }), statistics);
    labelInputs(element("panel"));
  }

  private wind(folder: FolderApi): void {
    this.windNumber(folder, "mean_speed_m_s", { label: "Mean speed (m/s)", format: fine });
    const { settings } = this.store;
    bind(
      folder,
      { label: "From (90° = east)", format: whole, ...WIND_LIMITS.direction_deg },
      () => bearingFrom_deg(withinTurn(settings.wind).direction_deg),
      (bearing) => {
        settings.wind = withPlain(settings.wind, { direction_deg: directionFrom_deg(bearing) });
      },
    );
    this.windNumber(folder, "gustiness", { label: "Gustiness", format: hundredths });
    this.windNumber(folder, "seed", { label: "Gust seed", format: whole });
    this.choice(folder, "flutter", { label: "Leaf flutter" });
  }

  /** A number of the wind document; changes apply immediately. */
  private windNumber(folder: FolderApi, key: keyof PlainWind, params: BindingParams): void {
    const { settings } = this.store;
    bind(
      folder,
      { ...params, ...WIND_LIMITS[key] },
      () => withinTurn(settings.wind)[key],
      (value) => {
        settings.wind = withPlain(settings.wind, { [key]: value });
      },
    );
  }

  /** Trees are placed again only when the slider is released. */
  private placement(
    folder: FolderApi,
    key: "trees" | "density" | "forestSeed" | "ownTrees",
    params: BindingParams,
    range: { max?: number } = {},
  ): BladeApi {
    const { settings } = this.store;
    return bind(
      folder,
      { ...params, ...LIMITS[key], ...range },
      () => settings[key],
      (value, released) => {
        if (released) settings[key] = value;
      },
    );
  }

  private choice<K extends keyof Settings>(folder: FolderApi, key: K, params: BindingParams): BladeApi {
    const { settings } = this.store;
    return bind(
      folder,
      params,
      () => settings[key],
      (value) => {
        settings[key] = value;
      },
    );
  }

  private forest(folder: FolderApi): void {
    // A slider up to the limit would move by hundreds of trees per pixel.
    const most = this.store.settings.trees > SLIDER_TREES ? LIMITS.trees.max : SLIDER_TREES;
    this.placement(folder, "trees", { label: "Number of trees", format: whole }, { max: most });
    this.placement(folder, "density", { label: "Density", format: hundredths });
    this.placement(folder, "forestSeed", { label: "Placement seed", format: whole });
    this.choice(folder, "form", {
      label: "Tree form",
      options: { "By location": "place", "Open-grown": "open", "Forest-grown": "forest" },
    });
    const own = this.placement(folder, "ownTrees", { label: "Own trees", format: whole });
    this.choice(folder, "background", { label: "Distant forest" });
    this.choice(folder, "quality", {
      label: "Render quality",
      options: { Low: "low", Medium: "medium", High: "high" },
    });
    this.choice(folder, "frameRateLimit_hz", {
      label: "Frame rate",
      options: { "Display rate": LIMITS.frameRateLimit_hz.max, "At most 30": 30, "At most 15": 15 },
    });
    followSlider(own, this.store, this.growth); // last, as Tweakpane counts the elements before those that it adds
  }

  private motion(folder: FolderApi): void {
    const { playback } = this.store;
    folder.addBinding(playback, "speed", { label: "Speed", options: PLAYBACK_SPEEDS });
    const times = (value: number) => `×${value.toFixed(1)}`;
    this.choice(folder, "exaggeration", { label: "Exaggeration", format: times, ...LIMITS.exaggeration });
    folder.addButton({ title: "Pause and step" }).on("click", () => playback.step());
    this.choice(folder, "lookup", {
      label: "Computed",
      options: { "In this browser": "worker", "On the server": "server" },
    });
    const method = this.choice(folder, "method", {
      label: "Method",
      options: { "Modal model": "modal", "Paper's state search": "paper" },
    });
    method.element.after(this.methodNote);
    this.methodNote.hidden = true;
    this.easing(folder.addFolder({ title: "Advanced", expanded: false }));
  }

  /** A switch between the easing of each table and one for all, which has a slider. */
  private easing(folder: FolderApi): void {
    const { settings } = this.store;
    bind(
      folder,
      { label: "Custom easing" },
      () => settings.poseEasing !== null,
      (own) => {
        settings.poseEasing = own ? 0.05 : null;
      },
    );
    const slider = bind(
      folder,
      { label: "Pose easing", format: (value: number) => value.toFixed(3), ...LIMITS.poseEasing },
      () => settings.poseEasing ?? 0,
      (value) => {
        settings.poseEasing = value;
      },
    );
    effect(() => {
      slider.hidden = settings.poseEasing === null;
    });
  }

  /** Shows what the server has now, and what keeps trees from using the chosen method. */
  report(): void {
    const { kinds, uploads } = this.catalogue;
    this.list(this.species, kinds, (id, name) => this.share(id, name));
    this.list(this.uploads, uploads, (id, name) => this.planted(id, name));
    this.uploads.hidden = uploads.length === 0;
    const { note } = this.paper;
    if (this.methodNote.textContent === note) return;
    this.methodNote.textContent = note;
    this.methodNote.hidden = note === "";
  }

  /** Fills a folder with a control for each of a list, again when the list has changed. */
  private list(
    folder: FolderApi,
    listed: readonly { id: string; name: string }[],
    add: (id: string, name: string) => void,
  ): void {
    const key = JSON.stringify(listed);
    if (this.listed.get(folder) === key) return;
    this.listed.set(folder, key);
    for (const child of [...folder.children]) child.dispose();
    for (const { id, name } of listed) add(id, name);
    labelInputs(element("panel"));
  }

  /** The relative frequency of a species in the forest. */
  private share(id: string, label: string): void {
    const { settings } = this.store;
    bind(
      this.species,
      { label, min: 0, max: 1, step: 0.05, format: hundredths },
      () => settings.shares[id] ?? 1,
      (share, released) => {
        if (released) settings.shares = { ...settings.shares, [id]: share };
      },
    );
  }

  /** How an upload is planted. */
  private planted(id: string, label: string): void {
    const { settings } = this.store;
    bind<Planted | "none">(
      this.uploads,
      { label, options: PLANTED_LABELS },
      () => plantedAs(settings, id) ?? "none",
      (how) => plantAs(settings, id, how === "none" ? null : how),
    );
  }
}

/**
 * Binds a control to a value in both directions: `read` is followed, and `write` is called with what the visitor chooses;
 * `released`: whether a slider has been let go.
 */
function bind<V>(
  folder: FolderApi,
  params: BindingParams,
  read: () => V,
  write: (value: V, released: boolean) => void,
): BladeApi {
  const shown: { value: unknown } = { value: read() };
  /** Tweakpane reports a refresh as a change, with values clamped to the slider's limits. */
  let refreshing = false;
  const binding = folder.addBinding(shown, "value", params).on("change", ({ value, last }) => {
    if (!refreshing) write(value as V, last);
  });
  const end = effect(() => {
    shown.value = read();
    refreshing = true;
    binding.refresh();
    refreshing = false;
  });
  binding.controller.viewProps.handleDispose(end);
  return binding;
}

function figures(folder: FolderApi, statistics: Statistics): void {
  const show = (key: keyof Statistics, label: string, format?: (value: number) => string) =>
    folder.addBinding(statistics, key, {
      readonly: true,
      label,
      interval: 500,
      ...(format && { format }),
    });
  folder.addBinding(statistics, "framesPerSecond", {
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
