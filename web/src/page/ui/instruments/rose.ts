/** The wind rose: drag the arrow's end, or use the arrow keys. The dial turns with the camera. */
import { FASTEST_M_S } from "../../settings/windLimits";
import { windInWords } from "./beaufort";
import { type DialWind, placeOfWind, RINGS_M_S, radiusOf, windAfterKey, windAtPlace } from "./dial";

const SVG_NAMESPACE = "http://www.w3.org/2000/svg";
const RIM_RADIUS = 64;
const HALF_VIEW_SIZE = 84;
const LETTERS = { E: 0, S: 90, W: 180, N: 270 } as const;

function draw<K extends keyof SVGElementTagNameMap>(
  parent: SVGElement,
  tag: K,
  attributes: Record<string, string | number>,
): SVGElementTagNameMap[K] {
  const made = document.createElementNS(SVG_NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  parent.append(made);
  return made;
}

export class WindRose {
  readonly element = document.createElementNS(SVG_NAMESPACE, "svg");
  private readonly letters: SVGTextElement[];
  private readonly labels: { label: SVGTextElement; radius: number }[];
  private readonly shaft: SVGLineElement;
  private readonly handle: SVGGElement;
  private wind: DialWind = { direction_deg: 0, mean_speed_m_s: 0 };
  private turn_deg = 0;
  /** Position of the dial at the start of the drag, so that a layout shift during the drag does not change the wind. */
  private dial: DOMRect | null = null;

  constructor(private readonly changed: (wind: DialWind) => void) {
    const svg = this.element;
    svg.setAttribute(
      "viewBox",
      `${-HALF_VIEW_SIZE} ${-HALF_VIEW_SIZE} ${2 * HALF_VIEW_SIZE} ${2 * HALF_VIEW_SIZE}`,
    );
    svg.classList.add("rose");
    draw(svg, "circle", { r: RIM_RADIUS + 16, class: "rose-face" });
    for (const speed_m_s of RINGS_M_S)
      draw(svg, "circle", { r: radiusOf(speed_m_s) * RIM_RADIUS, class: "rose-ring" });
    this.letters = Object.keys(LETTERS).map((letter) => {
      const text = draw(svg, "text", { class: "rose-letter", "text-anchor": "middle", dy: "0.35em" });
      text.textContent = letter;
      return text;
    });
    this.labels = RINGS_M_S.map((speed_m_s) => {
      const label = draw(svg, "text", { class: "rose-speed", "text-anchor": "middle", dy: "0.35em" });
      label.textContent = speed_m_s === FASTEST_M_S ? `${speed_m_s} m/s` : String(speed_m_s);
      return { label, radius: radiusOf(speed_m_s) * RIM_RADIUS };
    });
    this.shaft = draw(svg, "line", { class: "rose-shaft", x1: 0, y1: 0 });
    this.handle = draw(svg, "g", { class: "rose-handle", tabindex: 0, role: "slider" });
    this.handle.setAttribute("aria-label", "Wind");
    this.handle.setAttribute("aria-valuemin", "0");
    this.handle.setAttribute("aria-valuemax", String(FASTEST_M_S));
    draw(this.handle, "circle", { r: 20, class: "rose-reach" });
    draw(this.handle, "path", { d: "M 13 0 L -8 -9 L -4 0 L -8 9 Z", class: "rose-head" });
    this.listen();
  }

  private listen(): void {
    const svg = this.element;
    svg.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.dial = svg.getBoundingClientRect();
      svg.setPointerCapture(event.pointerId);
      this.handle.focus({ preventScroll: true });
      this.drag(event);
      event.preventDefault();
    });
    svg.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
      svg.addEventListener(end, () => {
        this.dial = null;
      });
    }
    this.handle.addEventListener("keydown", (event) => {
      const wind = windAfterKey(event.key, this.wind);
      if (!wind) return;
      event.preventDefault();
      event.stopPropagation();
      this.choose(wind);
    });
  }

  private drag(event: PointerEvent): void {
    const { dial } = this;
    if (!dial) return;
    const unit = (dial.width / (2 * HALF_VIEW_SIZE)) * RIM_RADIUS;
    const right = (event.clientX - dial.left - dial.width / 2) / unit;
    const down = (event.clientY - dial.top - dial.height / 2) / unit;
    this.choose(windAtPlace({ right, down }, this.turn_deg, this.wind));
  }

  /** The speeds of the rings, between two letters on the side that the arrow leaves free. */
  private placeLabels(arrow_deg: number): void {
    const quarters = Math.round((arrow_deg + 135 - this.turn_deg) / 90);
    const angle = ((this.turn_deg + 45 + 90 * quarters) * Math.PI) / 180;
    for (const { label, radius } of this.labels) {
      label.setAttribute("x", String(radius * Math.cos(angle)));
      label.setAttribute("y", String(radius * Math.sin(angle)));
    }
  }

  private choose(wind: DialWind): void {
    this.show(wind, this.turn_deg);
    this.changed(wind);
  }

  /** Shows a wind on a dial rotated by `turn_deg`. */
  show(wind: DialWind, turn_deg: number): void {
    if (wind === this.wind && turn_deg === this.turn_deg) return;
    this.wind = wind;
    this.turn_deg = turn_deg;
    const { right, down } = placeOfWind(wind, turn_deg);
    this.placeLabels(wind.direction_deg + turn_deg);
    this.shaft.setAttribute("x2", String(right * RIM_RADIUS));
    this.shaft.setAttribute("y2", String(down * RIM_RADIUS));
    const place = `translate(${right * RIM_RADIUS} ${down * RIM_RADIUS}) rotate(${wind.direction_deg + turn_deg})`;
    this.handle.setAttribute("transform", place);
    this.handle.setAttribute("aria-valuenow", wind.mean_speed_m_s.toFixed(1));
    this.handle.setAttribute("aria-valuetext", windInWords(wind.mean_speed_m_s, wind.direction_deg));
    Object.values(LETTERS).forEach((angle_deg, k) => {
      const angle = ((angle_deg + turn_deg) * Math.PI) / 180;
      this.letters[k].setAttribute("x", String((RIM_RADIUS + 9) * Math.cos(angle)));
      this.letters[k].setAttribute("y", String((RIM_RADIUS + 9) * Math.sin(angle)));
    });
  }
}
