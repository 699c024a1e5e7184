/**
 * What the features of the page share: the settings, the playback and the state of this visit. All are signals, so a
 * feature subscribes to what it needs, and whoever changes a value need not know who does.
 */
import { batch } from "@preact/signals-core";
import type { Individual } from "../../scene/individuals";
import type { NamedInventory } from "../inventory/namedInventory";
import { type Moment, momentFrom } from "../settings/link";
import { DEFAULTS, type Settings } from "../settings/settings";
import { sharedFrom } from "../settings/sharedForest";
import { Playback } from "./playback";
import { reactive, watch } from "./signals";

/** How far the forest's own trees are: wanted, asked for, planted, or refused by the server (`final`: for good). */
export type GrowthState =
  | { readonly at: "none" }
  | { readonly at: "growing"; readonly done: number; readonly all: number }
  | { readonly at: "planted"; readonly trees: number; readonly shown: number; readonly all: number }
  | { readonly at: "refused"; readonly title: string; readonly hint: string; readonly final: boolean };

/** What is true of this visit only. Who writes a value is named with it. */
export interface PageState {
  /** Id of the shared forest; null while the forest is private. `Sharing`. */
  share: string | null;
  /** Clients of the shared forest, this one included; null while unknown. `ForestClient`. */
  present: number | null;
  /** The inventory that is planted; null without one. `InventoryPlanting`. */
  inventory: NamedInventory | "loading" | null;
  /** The trees that were grown for the forest; empty: the built-in ones stand for all. `Individuals`. */
  individuals: readonly Individual[];
  growth: GrowthState;
  /** Whether the event stream of the server is open. `Catalogue`. */
  connected: boolean;
  /** Whether trees have been seen to move. `FrameLoop`. */
  treesSeen: boolean;
  /** Whether nobody has looked at the page for a while. `followAttention`. */
  away: boolean;
  /** Whether clicks on the ground place the anemometer. `WindStudio`. */
  placing: boolean;
  /** Whether a video is being recorded. `Capture`. */
  filming: boolean;
  /** Whether the wind is heard, and how loud, 0..1. `WindSound`, `Panel`. */
  sound: boolean;
  volume: number;
  /** Whether the forest neither advances nor draws, to leave the processor to other work. `Comparison`, probe. */
  asleep: boolean;
  /** Whether the clock of the forest stands still, also for those who share it. `World`. */
  stopped: boolean;
}

const SETTING_KEYS = Object.keys(DEFAULTS) as (keyof Settings)[];

export class Store {
  readonly settings: Settings;
  readonly playback = new Playback();
  readonly state: PageState;
  /** Camera, clock and clouds of the link that was opened. */
  readonly opened: { readonly [K in keyof Moment]: Moment[K] | null };
  private byOthers = false;
  private usual: Settings;

  /** `query`: that of the address. Settings are stored as differences from `defaults`. */
  constructor(settings: Settings, defaults: Settings, query: string) {
    this.usual = defaults;
    this.settings = reactive(settings);
    this.opened = momentFrom(query);
    this.state = reactive<PageState>({
      share: sharedFrom(query),
      present: null,
      inventory: null,
      individuals: [],
      growth: { at: "none" },
      connected: true,
      treesSeen: false,
      away: false,
      placing: false,
      filming: false,
      sound: false,
      volume: 0.5,
      asleep: false,
      stopped: false,
    });
  }

  /** Time at which the forest starts, s. */
  get from_s(): number {
    return this.opened.time_s ?? 0;
  }

  /** What the settings are where nothing else was chosen. */
  get defaults(): Settings {
    return this.usual;
  }

  /** Takes what suits the graphics, once these are known: only number of trees and quality depend on them. */
  suit({ trees, quality }: Settings, defaults: Settings): void {
    this.usual = defaults;
    this.change({ trees, quality });
  }

  /** Changes several settings at once. */
  change(values: Partial<Settings>): void {
    batch(() => Object.assign(this.settings, values));
  }

  /** Takes over what another visitor of a shared forest has changed. Call it from an event, not from a subscription. */
  adopt(values: Partial<Settings>): void {
    this.byOthers = true;
    try {
      this.change(values);
    } finally {
      this.byOthers = false;
    }
  }

  /** Whether the change that is being announced was made by another visitor. */
  get isAdopting(): boolean {
    return this.byOthers;
  }

  /** Calls `then` with the names of the settings that have changed. */
  onChange(then: (keys: readonly (keyof Settings)[]) => void): void {
    watch(
      () => SETTING_KEYS.map((key) => this.settings[key]),
      (now, before) => then(SETTING_KEYS.filter((_, k) => now[k] !== before[k])),
    );
  }
}
