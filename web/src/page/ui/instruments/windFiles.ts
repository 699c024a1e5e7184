/** Download and upload of a wind document as a file. */
import { parseWindText, type WindDocument, WindError } from "../../../core/wind/wind";
import { make } from "../dom";
import { saveFile } from "../saveFile";

const LARGEST_BYTES = 65_536;

/** Parses a wind from JSON text; throws WindError with the path of the fault. */
export function windFromText(text: string): WindDocument {
  if (text.length > LARGEST_BYTES)
    throw new WindError("wind", `expected at most ${LARGEST_BYTES} characters`);
  return parseWindText(text);
}

export function saveWind(wind: WindDocument): void {
  const text = `${JSON.stringify(wind, null, 2)}\n`;
  saveFile(new Blob([text], { type: "application/json" }), "wind.json");
}

/** A hidden file input; `choose` opens it. */
export class WindFileInput {
  readonly element = make("input");

  constructor(loaded: (wind: WindDocument) => void, refused: (why: WindError) => void) {
    this.element.type = "file";
    this.element.accept = ".json,application/json";
    this.element.hidden = true;
    this.element.dataset.testid = "wind-file";
    this.element.addEventListener("change", async () => {
      const file = this.element.files?.[0];
      this.element.value = "";
      if (!file) return;
      try {
        loaded(windFromText(await file.text()));
      } catch (error) {
        if (error instanceof WindError) refused(error);
        else throw error;
      }
    });
  }

  choose(): void {
    this.element.click();
  }
}
