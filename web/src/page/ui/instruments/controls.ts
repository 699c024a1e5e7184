/** Wind model, gust sliders and seed. */
import { FIELDS, hasField, MODELS, type WindDocument, type WindModel, type WindNumber } from "galewood/wind";
import { make, makeButton } from "../dom";
import { withModel } from "./windEditing";

const MODEL_NAMES: Record<WindModel, string> = {
  cosine: "Cosine waves",
  perlin: "Perlin noise",
  spectral: "1/f^β turbulence",
  "navier-stokes": "Navier–Stokes eddies",
  recorded: "Measured",
};

interface Slider {
  readonly name: WindNumber;
  readonly label: string;
  readonly title: string;
  readonly low: number;
  readonly high: number;
  readonly step: number;
  words(value: number): string;
}

const SLIDERS: readonly Slider[] = [
  {
    name: "gustiness",
    label: "Gustiness",
    title: "Strength of the gusts relative to the mean wind",
    low: FIELDS.gustiness.low,
    high: FIELDS.gustiness.high,
    step: 0.01,
    words: (value) => `${Math.round(100 * value)} %`,
  },
  {
    name: "length_scale_m",
    label: "Gust size",
    title: "Length scale of the gusts",
    low: FIELDS.length_scale_m.low,
    high: 100,
    step: 1,
    words: (value) => `${Math.round(value)} m`,
  },
  {
    name: "convection_speed_m_s",
    label: "Gust speed",
    title: "Speed at which gusts travel through the forest",
    low: 1,
    high: 30,
    step: 0.5,
    words: (value) => `${value.toFixed(1)} m/s`,
  },
  {
    name: "beta",
    label: "Slope β",
    title: "Power falls with frequency as 1/f^β: 0 is white noise, 5/3 is turbulence",
    low: FIELDS.beta.low,
    high: FIELDS.beta.high,
    step: 0.01,
    words: (value) => value.toFixed(2),
  },
];

export class WindControls {
  readonly element = make("div", "", "wind-controls");
  private readonly model = make("select");
  private readonly measured: HTMLOptionElement;
  private readonly rows: {
    slider: Slider;
    row: HTMLElement;
    input: HTMLInputElement;
    output: HTMLOutputElement;
  }[];

  constructor(private readonly current: { wind: WindDocument }) {
    for (const name of MODELS) this.model.append(new Option(MODEL_NAMES[name], name));
    this.measured = this.model.options[MODELS.indexOf("recorded")];
    this.model.addEventListener("change", () => {
      current.wind = withModel(current.wind, this.model.value as WindModel);
    });
    this.element.append(labelled("Wind model", this.model));
    this.rows = SLIDERS.map((slider) => this.makeRow(slider));
    const seed = makeButton("New random gusts", () => {
      current.wind = { ...current.wind, seed: Math.floor(Math.random() * 10_000) };
    });
    seed.title = "Same wind with different gusts (new seed)";
    this.element.append(seed);
  }

  private makeRow(slider: Slider) {
    const input = make("input");
    Object.assign(input, { type: "range", min: slider.low, max: slider.high, step: slider.step });
    input.title = slider.title;
    input.dataset.field = slider.name;
    input.addEventListener("input", () => {
      this.current.wind = { ...this.current.wind, [slider.name]: Number(input.value) };
    });
    const output = make("output");
    const row = labelled(slider.label, input, output);
    this.element.append(row);
    return { slider, row, input, output };
  }

  show(): void {
    const { wind } = this.current;
    // a measurement is loaded from a file, not chosen here
    this.measured.hidden = this.measured.disabled = wind.model !== "recorded";
    this.model.value = wind.model;
    for (const { slider, row, input, output } of this.rows) {
      row.hidden = !hasField(wind.model, slider.name);
      const standard = slider.name === "beta" ? 5 / 3 : slider.low;
      const value = wind[slider.name] ?? standard;
      input.value = String(value);
      output.textContent = slider.words(value);
    }
  }
}

function labelled(text: string, ...controls: HTMLElement[]): HTMLLabelElement {
  const label = make("label");
  label.append(make("span", text), ...controls);
  return label;
}
