/** Tables of measurements, which the service reads. */
import type { Foliage } from "galewood/core";
import { fetchApi, Problem } from "./api";
import type { Schemas } from "./schema";

export type MeasuredWind = Schemas["MeasuredWindOut"];
/** The stems of an inventory in wind, in its order. */
export type StandRisk = Schemas["StandRiskOut"];
export type StemRisk = Schemas["StemRiskOut"];
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
    if (error instanceof Problem && error.status === UNKNOWN_CONTENT) return null;
    throw withoutService(error, [
      "Only a service can read this file.",
      "This page has none. Convert the file with `galewood convert`, and drop the JSON file here.",
    ]);
  }
}

export interface RiskRequest {
  readonly foliage: Foliage;
  readonly speed_m_s: number;
}

/**
 * The wind risk of the stems of an inventory, computed by the service, as JSON or as a table. `inventory`: its file or its
 * document. Throws a Problem, or an AbortError once `signal` is aborted.
 */
export async function fetchRisk(
  inventory: Blob,
  { foliage, speed_m_s }: RiskRequest,
  format: "json" | "csv",
  signal?: AbortSignal,
): Promise<Response> {
  // fetch says of a file that has changed what it says without a connection
  const body = await inventory.arrayBuffer().catch(() => {
    throw new Problem("The inventory can no longer be read.", "Its file has changed: drop it here again.");
  });
  try {
    const init = { method: "POST", body, ...(signal && { signal }) };
    return await fetchApi(`api/stand-risk?foliage=${foliage}&speed_m_s=${speed_m_s}&format=${format}`, init);
  } catch (error) {
    throw withoutService(error, [
      "Only a service can compute the wind risk.",
      "This page has none. Use `galewood stand` with the file of the inventory.",
    ]);
  }
}

/** What to throw for an error: a problem of these words if nobody has the route. */
function withoutService(error: unknown, [title, hint]: readonly [string, string]): unknown {
  return error instanceof Problem && NO_SERVICE.includes(error.status) ? new Problem(title, hint) : error;
}
