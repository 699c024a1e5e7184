/** Season and time of day: four buttons and a slider that follows the sun. */

import { effect } from "@preact/signals-core";
import { SEASONS, type Season } from "../../scene/season/season";
import { clockOf, DAYTIMES } from "../../scene/sky/daytime";
import { element, make, makeButton } from "../ui/dom";

/** Signals. */
export interface Scenery {
  season: Season;
  daytime: number;
}

const WORDS: Record<Season, string> = {
  spring: "Spring",
  summer: "Summer",
  autumn: "Autumn",
  winter: "Winter",
};

/** Name of the part of the day. */
function partOfDay(daytime: number): string {
  if (daytime < -0.05 || daytime > 1.05) return "night";
  if (daytime < 0) return "dawn";
  if (daytime < 0.06) return "sunrise";
  if (daytime < 0.36) return "morning";
  if (daytime < 0.6) return "midday";
  if (daytime < 0.86) return "afternoon";
  if (daytime < 0.95) return "evening";
  return daytime <= 1 ? "sunset" : "dusk";
}

export class SceneryBar {
  private readonly buttons: { season: Season; button: HTMLButtonElement }[];
  private readonly slider = make("input");
  private readonly clock = make("output");

  constructor(private readonly scenery: Scenery) {
    this.buttons = SEASONS.map((season) => this.seasonButton(season));
    const seasons = make("div", "", "seasons");
    seasons.setAttribute("role", "group");
    seasons.setAttribute("aria-label", "Season");
    seasons.append(...this.buttons.map(({ button }) => button));
    element("scenery").replaceChildren(seasons, this.timeSlider());
    effect(() => this.show());
  }

  private seasonButton(season: Season) {
    const button = makeButton(WORDS[season], () => {
      this.scenery.season = season;
    });
    button.dataset.season = season;
    return { season, button };
  }

  private timeSlider(): HTMLElement {
    const { slider } = this;
    Object.assign(slider, { type: "range", ...DAYTIMES });
    slider.setAttribute("aria-label", "Time of day");
    slider.addEventListener("input", () => {
      this.scenery.daytime = Number(slider.value);
    });
    const label = make("div", "", "daytime");
    label.append(slider, this.clock);
    return label;
  }

  private show(): void {
    const { season, daytime } = this.scenery;
    for (const { season: own, button } of this.buttons)
      button.setAttribute("aria-pressed", String(own === season));
    this.slider.value = String(daytime);
    const clock = clockOf(daytime, season);
    this.slider.setAttribute("aria-valuetext", `${clock}, ${partOfDay(daytime)}`);
    this.clock.textContent = clock;
  }
}
