/** Tables of measurements, which the service reads. */
import { fetchApi, Problem } from "./api";
import type { Schemas } from "./schema";

export type MeasuredWind = Schemas["MeasuredWindOut"];
type Converted = Schemas["InventoryOut"] | MeasuredWind;

const UNKNOWN_CONTENT = 415;
/** What servers of files answer to a request for which only the service has a route. */
const NO_SERVICE = [404, 405, 501];

/**
 * Sends a file of stems or of an anemometer to the service. `start_s`: where the used part of a record begins. Null if
 * the file is neither. Throws a Problem that says what is wrong.
 */
export async function convertFile(file: Blob, start_s = 0): Promise<Converted | null> {
  try {
    const init = { method: "POST", body: file };
    return (await (await fetchApi(`api/convert?start_s=${start_s}`, init)).json()) as Converted;
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    if (error.status === UNKNOWN_CONTENT) return null;
    if (!NO_SERVICE.includes(error.status)) throw error;
    throw new Problem(
      "Only a service can read this file.",
      "This page has none. Convert the file with `galewood convert`, and drop the JSON file here.",
    );
  }
}
