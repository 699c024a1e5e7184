/** A measured wind: it blows at once, and a dialog shows how its file was interpreted. */

import { parseWind, type WindDocument } from "galewood/wind";
import { Problem } from "../server/api";
import { convertFile, type MeasuredWind } from "../server/conversion";
import { make } from "../ui/dom";
import { showReport } from "../ui/reportDialog";
import { showToast } from "../ui/toast";

type Blow = (wind: WindDocument) => void;

/** Passes the wind on and shows its report, in which another part of a long record can be chosen. */
export function playMeasuredWind(file: File, { wind, report }: MeasuredWind, blow: Blow): void {
  blow(parseWind(wind));
  const close = showReport({
    heading: "Measured wind",
    file: file.name,
    figures: Object.entries(report.figures),
    notes: report.notes,
    control: partChoice(report, (start_s) => {
      close();
      void playFrom(file, start_s, blow);
    }),
  });
}

async function playFrom(file: File, start_s: number, blow: Blow): Promise<void> {
  try {
    const found = await convertFile(file, start_s);
    if (found && "wind" in found) playMeasuredWind(file, found, blow);
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    showToast(error.title, error.hint);
  }
}

/** Chooses the part of a long measurement; nothing if all of it is used. */
function partChoice(
  { duration_s, used_s, used_start_s, gaps }: MeasuredWind["report"],
  choose: (start_s: number) => void,
): HTMLElement | undefined {
  const spare_s = duration_s - used_s;
  if (spare_s < 60 || gaps > 0) return undefined;
  const label = make("label", "Begin after (minutes) ");
  const input = make("input");
  Object.assign(input, { type: "number", min: 0, max: Math.floor(spare_s / 60), step: 1 });
  input.value = String(Math.round(used_start_s / 60));
  input.addEventListener("change", () => choose(60 * Number(input.value)));
  label.append(input);
  return label;
}
