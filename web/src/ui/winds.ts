/** Five wind strengths, one press each. */
import { element, make } from "./dom";
import { WINDS, windName } from "./words";

export class WindButtons {
  private readonly buttons: HTMLButtonElement[];

  constructor(choose: (mean_m_s: number) => void) {
    this.buttons = WINDS.map(({ name, mean_m_s }) => {
      const button = make("button", name);
      button.type = "button";
      button.addEventListener("click", () => choose(mean_m_s));
      return button;
    });
    element("winds").append(...this.buttons);
  }

  show(mean_m_s: number): void {
    const name = windName(mean_m_s);
    for (const button of this.buttons)
      button.setAttribute("aria-pressed", String(button.textContent === name));
  }
}
