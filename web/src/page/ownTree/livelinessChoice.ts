/** Shows how an uploaded tree is expected to move, with a slider that makes it livelier than its wood. */

import type { BuildSettings } from "../server/api";
import { make } from "../ui/dom";
import {
  defaultLiveliness,
  type ExpectedMotion,
  frequency_Hz,
  isAdjustable,
  swaysAt,
  swaysInWords,
} from "./expectedMotion";

const STIFF_TEXT =
  "With the stiffness of its wood, its motion would be barely visible. It is therefore made softer, to sway like real " +
  "trees of its height; move the slider to the left to keep the stiffness of its wood.";
const STILL_TEXT = "Its motion will be barely visible.";
const MEASURED_TEXT =
  "Its motion will be barely visible with the stiffness of its wood, which a scanned tree keeps. Move the slider to the " +
  "right for more motion.";
const NATURAL_TEXT = "It has the stiffness of its wood. Move the slider to the right for more motion.";

export class LivelinessChoice {
  readonly root = make("div", "", "own-tree-motion");
  private readonly slider = make("input");
  private readonly words = make("p");
  private readonly reason = make("small");
  private expected: ExpectedMotion | null = null;

  constructor() {
    const label = make("label");
    Object.assign(this.slider, { type: "range", min: "0", max: "1", step: "0.01" });
    this.words.setAttribute("aria-live", "polite");
    const ends = make("span", "", "own-tree-ends");
    ends.append(make("span", "stiffness of its wood"), make("span", "lively"));
    label.append(make("span", "Stiffness"), this.slider, ends);
    this.slider.addEventListener("input", () => this.notify());
    this.root.append(make("strong", "Expected sway"), this.words, label, this.reason);
  }

  /** Shows another expectation; the slider starts at what the service chooses. */
  show(expected: ExpectedMotion | null): void {
    this.expected = expected;
    this.root.hidden = expected === null;
    if (!expected) return;
    const adjustable = isAdjustable(expected);
    if (this.slider.parentElement) this.slider.parentElement.hidden = !adjustable;
    this.reason.hidden = !adjustable && expected.visible;
    const start = defaultLiveliness(expected);
    this.slider.value = String(start);
    const still = !adjustable ? STILL_TEXT : start === 0 ? MEASURED_TEXT : STIFF_TEXT;
    this.reason.textContent = expected.visible ? NATURAL_TEXT : still;
    this.notify();
  }

  private get liveliness(): number {
    return this.expected && isAdjustable(this.expected) ? this.slider.valueAsNumber : 0;
  }

  private notify(): void {
    if (!this.expected) return;
    const hertz = frequency_Hz(this.expected, this.liveliness);
    const sways = swaysInWords(swaysAt(this.expected, this.liveliness));
    this.words.textContent = `${sways}; first frequency ${hertz.toPrecision(2)} Hz`;
    this.slider.setAttribute("aria-valuetext", `${hertz.toPrecision(2)} hertz`);
  }

  /** The settings to ask for: none at the service's own choice. */
  get settings(): BuildSettings {
    const { expected, liveliness } = this;
    if (!expected || !isAdjustable(expected) || liveliness === defaultLiveliness(expected)) return {};
    return liveliness === 0
      ? { stiffness: "as drawn" }
      : { first_frequency_hz: frequency_Hz(expected, liveliness) };
  }
}
