/** The wind risk of the selected stem, on the card of the selected tree. */
import type { StandRisk } from "../server/conversion";
import { make, PHONE_PAGE } from "../ui/dom";
import { stemFigures, stemMarks, stemName } from "./stemWords";

export class StemCard {
  readonly root = make("details", "", "stem-risk");
  private readonly summary = make("summary");
  private readonly list = make("dl");
  private readonly marks = make("div");

  constructor() {
    this.root.open = !matchMedia(PHONE_PAGE).matches;
    this.root.append(this.summary, this.list, this.marks);
    this.show(null, 0, 0);
  }

  /** Shows a stem in a gust; without a result the card is hidden. */
  show(risk: StandRisk | null, index: number, speed_m_s: number): void {
    const stem = risk?.stems[index];
    this.root.hidden = !stem;
    if (!risk || !stem) return;
    this.summary.textContent = `Wind risk: ${stemName(stem)}`;
    this.list.replaceChildren(
      ...stemFigures(stem, risk.stems.length, speed_m_s).map(([name, value]) => {
        const row = make("div");
        row.append(make("dt", name), make("dd", value));
        return row;
      }),
    );
    this.marks.replaceChildren(
      ...stemMarks(stem, speed_m_s).map((words) => make("p", words)),
      make("p", risk.caution, "risk-caution"),
    );
  }
}
