/** Card of the wind risk of an inventory: what is asked, the colours of the stems, and those that break first. */
import type { RiskRequest, StandRisk } from "../server/conversion";
import { make, makeButton, write } from "../ui/dom";
import { classWords, colouringOf, QUANTITIES, type QuantityName, valueWords } from "./colourScale";
import { stemName } from "./stemWords";

export type ColouredBy = QuantityName | "none";

export interface RiskTools {
  calculate(): void;
  cancel(): void;
  colour(by: ColouredBy): void;
  /** Selects a stem, by its place in the inventory. */
  select(stem: number): void;
  save(): void;
}

const FOLIAGE_WORDS = { leaf: "In leaf", bare: "Bare" } as const;
const FIRST_STEMS = 10;
const USUAL_SPEED_M_S = 20;
const SPEED_LIMITS_M_S = { min: 1, max: 100 } as const;

/** A label and its control in a row. */
function labelled(words: string, control: HTMLElement): HTMLLabelElement {
  const label = make("label");
  label.append(make("span", words), control);
  return label;
}

function makeSelect(choices: Readonly<Record<string, string>>): HTMLSelectElement {
  const select = make("select");
  for (const [value, words] of Object.entries(choices)) select.append(new Option(words, value));
  return select;
}

export class RiskCard {
  readonly root = make("details", "", "card risk");
  private readonly foliage = makeSelect(FOLIAGE_WORDS);
  private readonly speed = make("input");
  private readonly form = make("form");
  private readonly calculate = make("button", "Calculate");
  private readonly cancel: HTMLButtonElement;
  private readonly bar = make("progress");
  private readonly state = make("p", "", "risk-state");
  private readonly result = make("div", "", "risk-result");
  private readonly by: HTMLSelectElement;
  private readonly legend = make("ul", "", "risk-legend");
  private readonly first = make("ol", "", "risk-first");
  private readonly assumptions = make("ul");
  private readonly caution = make("p", "", "risk-caution");

  constructor(private readonly tools: RiskTools) {
    const { form, speed, bar } = this;
    speed.type = "number";
    Object.assign(speed, { min: String(SPEED_LIMITS_M_S.min), max: String(SPEED_LIMITS_M_S.max), step: "1" });
    speed.value = String(USUAL_SPEED_M_S);
    speed.required = true;
    this.calculate.type = "submit";
    this.cancel = makeButton("Cancel", () => tools.cancel());
    bar.setAttribute("aria-label", "Calculating the wind risk"); // without a value: the time is not known
    this.state.setAttribute("role", "status");
    form.append(labelled("Foliage", this.foliage), labelled("Gust, m/s", speed), this.calculate, this.cancel);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      tools.calculate();
    });
    const choices = Object.entries(QUANTITIES).map(([name, { words }]) => [name, words]);
    this.by = makeSelect({ ...Object.fromEntries(choices), none: "Nothing" });
    this.by.addEventListener("change", () => tools.colour(this.by.value as ColouredBy));
    this.legend.setAttribute("aria-label", "Colours of the stems");
    const first = make("details");
    first.append(make("summary", "Stems that break first"), this.first);
    const assumed = make("details");
    assumed.append(make("summary", "Assumptions"), this.assumptions);
    this.result.append(
      labelled("Colour stems by", this.by),
      this.legend,
      first,
      assumed,
      this.caution,
      makeButton("Save as CSV", () => tools.save(), "risk-save"),
    );
    this.root.setAttribute("aria-label", "Wind risk of the stems");
    this.root.append(make("summary", "Wind risk"), form, bar, this.state, this.result);
    this.show(null, "none");
    this.busy(false);
  }

  /** What the visitor asks for. */
  get request(): RiskRequest {
    return { foliage: this.foliage.value as RiskRequest["foliage"], speed_m_s: this.speed.valueAsNumber };
  }

  busy(busy: boolean): void {
    this.calculate.disabled = busy;
    this.cancel.hidden = this.bar.hidden = !busy;
  }

  say(words: string): void {
    write(this.state, words);
  }

  /** Shows a result; null: none. */
  show(risk: StandRisk | null, by: ColouredBy): void {
    this.result.hidden = risk === null;
    if (!risk) return;
    this.showLegend(risk, by);
    const ranked = risk.stems.toSorted((a, b) => a.rank - b.rank).slice(0, FIRST_STEMS);
    this.first.replaceChildren(
      ...ranked.map((stem) => {
        const item = make("li");
        const breaks = valueWords("critical", stem.critical_m_s ?? Number.POSITIVE_INFINITY);
        item.append(makeButton(`${stemName(stem)}: ${breaks} m/s`, () => this.tools.select(stem.index)));
        return item;
      }),
    );
    this.assumptions.replaceChildren(...risk.assumptions.map((words) => make("li", words)));
    this.caution.textContent = risk.caution;
  }

  /** Scrolls to the result where there is no room for all. */
  reveal(): void {
    this.result.scrollIntoView({ block: "nearest" });
  }

  private showLegend(risk: StandRisk, by: ColouredBy): void {
    this.by.value = by;
    this.legend.hidden = by === "none";
    if (by === "none") return;
    const { unit } = QUANTITIES[by];
    this.legend.replaceChildren(
      ...colouringOf(risk, by).classes.map((one) => {
        const item = make("li", `${classWords(by, one)} ${unit}`);
        const swatch = make("span", "", "risk-swatch");
        swatch.style.background = one.colour;
        item.prepend(swatch);
        item.append(make("span", `${one.stems} ${one.stems === 1 ? "stem" : "stems"}`, "risk-count"));
        return item;
      }),
    );
  }
}
