/** Download of a wind document, and choice of a file with a wind. */
import type { WindDocument } from "galewood/wind";
import { make } from "../dom";
import { saveFile } from "../saveFile";

export function saveWind(wind: WindDocument): void {
  const text = `${JSON.stringify(wind, null, 2)}\n`;
  saveFile(new Blob([text], { type: "application/json" }), "wind.json");
}

/** A hidden input for a wind document or the record of an anemometer; a click opens it. */
export function windFileInput(chosen: (file: File) => void): HTMLInputElement {
  const input = make("input");
  input.type = "file";
  input.accept = ".json,.csv,.dat,.txt,.tsv,application/json,text/csv";
  input.hidden = true;
  input.dataset.testid = "wind-file";
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) chosen(file);
  });
  return input;
}
