/** A measured wind inside a wind document. */
import {
  FEWEST_RECORDING_SAMPLES,
  MOST_RECORDING_SAMPLES,
  RECORDING_FIELDS,
  STILL_RECORDING,
} from "../constants";
import { numberAt, objectAt, refuseUnknown, WindError } from "./fields";

// browsers, workers and Node have it, but it is not part of the language's library
declare function atob(text: string): string;

/** Fluctuations of a measured wind at equal intervals, quantised to 16 bits and repeated endlessly. */
export interface Recording {
  readonly interval_s: number;
  /** The fluctuation that one count stands for. */
  readonly unit: number;
  /** Fluctuations along and across the wind, in counts: int16, little-endian, base64. */
  readonly pairs: string;
}

export const EMPTY_RECORDING: Recording = STILL_RECORDING;

const SAMPLES_TEXT = `${FEWEST_RECORDING_SAMPLES}..${MOST_RECORDING_SAMPLES}`;
const EXPECTED_TEXT = `expected ${SAMPLES_TEXT} pairs of 16-bit integers, little-endian, in base64`;

/** Parses the field `recording`; throws WindError that names the invalid field. */
export function recordingAt(value: unknown, path: string): Recording {
  if (value === undefined || value === null) throw new WindError(path, "missing, expected an object");
  const fields = objectAt(value, path);
  refuseUnknown(fields, ["interval_s", "unit", "pairs"], path, "not a field of a recording");
  const interval_s = numberAt(fields, "interval_s", RECORDING_FIELDS.interval_s, path) as number;
  const unit = numberAt(fields, "unit", RECORDING_FIELDS.unit, path) as number;
  const { pairs } = fields;
  if (typeof pairs !== "string" || !isPairs(pairs)) throw new WindError(`${path}.pairs`, EXPECTED_TEXT);
  return { interval_s, unit, pairs };
}

function isPairs(text: string): boolean {
  if (
    text.length % 4 !== 0 ||
    text.length > 8 * MOST_RECORDING_SAMPLES ||
    !/^[A-Za-z0-9+/]+={0,2}$/.test(text)
  ) {
    return false;
  }
  const count = Math.floor((text.replace(/=/g, "").length * 3) / 4) / 4;
  return Number.isInteger(count) && count >= FEWEST_RECORDING_SAMPLES && count <= MOST_RECORDING_SAMPLES;
}

/** [count, 2] fluctuations along and across the wind, in standard deviations at this gustiness. */
export function fluctuations({ pairs, unit }: Recording): Float64Array {
  const bytes = Uint8Array.from(atob(pairs), (letter) => letter.charCodeAt(0));
  return Float64Array.from(new Int16Array(bytes.buffer), (count) => count * unit);
}
