/** The wind instruments: rose, description, presets, gust sliders, overlay, anemometer, files. */

import { effect } from "@preact/signals-core";
import { PRESETS, type PresetName, type WindDocument, withMean } from "galewood/wind";
import { element, make, makeButton, write } from "../dom";
import { Anemometer } from "./anemometer";
import { windInWords } from "./beaufort";
import { WindControls } from "./controls";
import { WindRose } from "./rose";
import { presetAt, presetOf } from "./windEditing";
import { saveWind, windFileInput } from "./windFiles";

const PRESET_NAMES: Record<PresetName, string> = {
  still: "Still",
  breeze: "Breeze",
  "autumn-gusts": "Autumn gusts",
  "storm-front": "Storm front",
};

/** Holds the page's wind, a signal; the instruments read and write it there and keep no copy. */
export interface CurrentWind {
  wind: WindDocument;
}

export interface InstrumentEvents {
  overlay(visible: boolean): void;
  /** Whether the next click on the ground places the anemometer. */
  placing(active: boolean): void;
  anemometerRemoved(): void;
  /** The visitor has chosen a file with a wind. */
  file(file: File): void;
}

export class Instruments {
  readonly anemometer = new Anemometer(() => this.removeAnemometer());
  private readonly rose = new WindRose(({ direction_deg, mean_speed_m_s }) => {
    this.wind = withMean(this.wind, mean_speed_m_s, direction_deg);
  });
  private readonly words = make("p", "", "wind-words");
  private readonly coverage = make("p", "", "wind-coverage");
  private readonly controls: WindControls;
  private readonly presets: { name: PresetName; button: HTMLButtonElement }[];
  private readonly overlayButton = toggle(
    "Show on ground",
    "Shows the wind as arrows on the ground: warm colours in gusts, blue in lulls",
  );
  private readonly placeButton = toggle("Anemometer", "Click on the ground to place an anemometer");

  constructor(
    private readonly current: CurrentWind,
    private readonly events: InstrumentEvents,
  ) {
    this.controls = new WindControls(current);
    this.presets = (Object.keys(PRESETS) as PresetName[]).map((name) => this.presetButton(name));
    this.overlayButton.addEventListener("click", () => events.overlay(flip(this.overlayButton)));
    this.placeButton.addEventListener("click", () => events.placing(flip(this.placeButton)));
    const box = element("instruments");
    box.replaceChildren(
      this.rose.element,
      this.words,
      this.details(),
      group("wind-tools", this.overlayButton, this.placeButton),
    );
    element("anemometer").replaceChildren(this.anemometer.element);
    element("winds").replaceChildren(...this.presets.map(({ button }) => button));
    effect(() => this.showWind());
  }

  private get wind(): WindDocument {
    return this.current.wind;
  }

  private set wind(wind: WindDocument) {
    this.current.wind = wind;
  }

  private presetButton(name: PresetName) {
    const button = makeButton(PRESET_NAMES[name], () => {
      this.wind = presetAt(name, this.wind.direction_deg);
    });
    return { name, button };
  }

  private details(): HTMLElement {
    const details = make("details");
    const save = makeButton("Download wind", () => saveWind(this.wind));
    const input = windFileInput((file) => this.events.file(file));
    const load = makeButton("Load wind…", () => input.click());
    load.title = "A wind document (JSON), or the recording of an anemometer (CSV)";
    details.append(
      make("summary", "Gust settings"),
      this.controls.element,
      this.coverage,
      group("wind-files", save, load, input),
    );
    return details;
  }

  private showWind(): void {
    const { wind } = this;
    write(this.words, windInWords(wind.mean_speed_m_s, wind.direction_deg));
    this.controls.show();
    const current = presetOf(wind);
    for (const { name, button } of this.presets)
      button.setAttribute("aria-pressed", String(name === current));
  }

  /** Turns the dial with the camera. */
  turn(turn_deg: number): void {
    this.rose.show(this.wind, turn_deg);
  }

  /** Shows the share of trees whose wind pressure is within the sampled range of their table. */
  showCoverage(share: number): void {
    const words =
      share >= 0.995
        ? "All trees are within the sampled range of winds."
        : `${Math.round(100 * share)} % of the trees are within the sampled range of winds; the others bend as in the strongest sampled wind.`;
    write(this.coverage, words);
  }

  anemometerPlaced(): void {
    this.placeButton.setAttribute("aria-pressed", "false");
  }

  private removeAnemometer(): void {
    this.anemometer.remove();
    this.events.anemometerRemoved();
  }
}

function toggle(text: string, title: string): HTMLButtonElement {
  const button = make("button", text);
  button.type = "button";
  button.title = title;
  button.setAttribute("aria-pressed", "false");
  return button;
}

/** Flips a toggle button; returns whether it is now pressed. */
function flip(button: HTMLButtonElement): boolean {
  const pressed = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", String(pressed));
  return pressed;
}

function group(className: string, ...children: HTMLElement[]): HTMLElement {
  const made = make("div", "", className);
  made.append(...children);
  return made;
}
