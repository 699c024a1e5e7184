/** Controls of a wind below a picture: a preset, its mean speed and where it blows to. */
import type { WindDocument } from "../core/wind/document";
import { PRESETS, type PresetName } from "../core/wind/presets";

const NAMES: Readonly<Record<PresetName, string>> = {
  still: "Still air",
  breeze: "Breeze",
  "autumn-gusts": "Autumn gusts",
  "storm-front": "Storm front",
};
/** The option of a wind that is no preset. */
const OTHER_OPTION = "";
const STRONGEST_M_S = 40;
/** A preset stays selected when only its speed or direction changes. */
const ADJUSTED_FIELDS: readonly string[] = ["mean_speed_m_s", "direction_deg"];

function sameButAdjusted(wind: WindDocument, preset: WindDocument): boolean {
  const fixed = (document: WindDocument) =>
    JSON.stringify(
      Object.entries(document)
        .filter(([name]) => !ADJUSTED_FIELDS.includes(name))
        .sort(),
    );
  return fixed(wind) === fixed(preset);
}

const presetOf = (wind: WindDocument): PresetName | typeof OTHER_OPTION =>
  (Object.keys(PRESETS) as PresetName[]).find((name) => sameButAdjusted(wind, PRESETS[name])) ?? OTHER_OPTION;

function labelled(text: string, ...controls: HTMLElement[]): HTMLLabelElement {
  const label = document.createElement("label");
  label.style.cssText = "display:inline-flex;align-items:center;gap:0.4em";
  label.append(text, ...controls);
  controls[0].setAttribute("aria-label", text); // without the options and the value beside it
  return label;
}

function slider(max: number, step: number): HTMLInputElement {
  const input = document.createElement("input");
  Object.assign(input, { type: "range", min: "0", max: `${max}`, step: `${step}` });
  input.style.width = "7em";
  return input;
}

export class WindControls {
  readonly element = document.createElement("div");
  private readonly presets = document.createElement("select");
  private readonly speed = slider(STRONGEST_M_S, 0.5);
  private readonly direction = slider(355, 5);
  private readonly speedText = document.createElement("output");
  private readonly directionText = document.createElement("output");

  constructor(
    private wind: WindDocument,
    private readonly changed: (wind: WindDocument) => void,
  ) {
    this.element.style.cssText =
      "display:flex;flex-wrap:wrap;gap:0.4em 1.4em;padding:0.4em 0;font:13px sans-serif";
    for (const name of Object.keys(NAMES) as PresetName[]) this.presets.append(new Option(NAMES[name], name));
    const other = new Option("Other", OTHER_OPTION);
    other.disabled = true;
    this.presets.append(other);
    for (const text of [this.speedText, this.directionText])
      text.style.cssText = "min-width:4em;font-variant-numeric:tabular-nums";
    this.element.append(
      labelled("Wind", this.presets),
      labelled("Mean speed", this.speed, this.speedText),
      labelled("Direction (towards)", this.direction, this.directionText),
    );
    this.presets.addEventListener("change", () => this.change(PRESETS[this.presets.value as PresetName]));
    this.speed.addEventListener("input", () =>
      this.change({ ...this.wind, mean_speed_m_s: this.speed.valueAsNumber }),
    );
    this.direction.addEventListener("input", () =>
      this.change({ ...this.wind, direction_deg: this.direction.valueAsNumber }),
    );
    this.show(wind);
  }

  /** Shows a wind that was changed elsewhere. */
  show(wind: WindDocument): void {
    this.wind = wind;
    this.presets.value = presetOf(wind);
    this.speed.value = `${wind.mean_speed_m_s}`;
    this.direction.value = `${(wind.direction_deg + 360) % 360}`;
    this.speedText.value = `${wind.mean_speed_m_s.toFixed(1)} m/s`;
    this.directionText.value = `${Math.round((wind.direction_deg + 360) % 360)}°`;
  }

  private change(wind: WindDocument): void {
    this.show(wind);
    this.changed(wind);
  }
}
