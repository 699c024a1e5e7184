/** Download and upload of a wind document as a file. */
import { parseWindText, type WindDocument, WindError } from "galewood/wind";
import { make } from "../dom";
import { saveFile } from "../saveFile";
import type { MeasurementEvents } from "./measurement";

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
class FileInput {
  readonly element = make("input");

  /** `take` reads a file, chosen or dropped. */
  constructor(
    accept: string,
    testId: string,
    readonly take: (file: File) => Promise<void>,
  ) {
    this.element.type = "file";
    this.element.accept = accept;
    this.element.hidden = true;
    this.element.dataset.testid = testId;
    this.element.addEventListener("change", () => {
      const file = this.element.files?.[0];
      this.element.value = "";
      if (file) void take(file);
    });
  }

  choose(): void {
    this.element.click();
  }
}

/** A wind document, as "Download wind" saves it. */
export class WindFileInput extends FileInput {
  constructor(loaded: (wind: WindDocument) => void, refused: (why: WindError) => void) {
    super(".json,application/json", "wind-file", async (file) => {
      try {
        loaded(windFromText(await file.text()));
      } catch (error) {
        if (error instanceof WindError) refused(error);
        else throw error;
      }
    });
  }
}

/** The file of an anemometer's logger. */
export class MeasurementInput extends FileInput {
  constructor(events: MeasurementEvents) {
    super(".csv,.dat,.txt,.tsv,text/csv", "measurement-file", async (file) => {
      const { loadMeasurement } = await import("./measurement");
      await loadMeasurement(file, events);
    });
  }
}
