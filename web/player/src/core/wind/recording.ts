/** A measured wind inside a wind document. Same as precompute/galewood/wind/recording.py. */
import { bytesOfBase64, textOfBase64 } from "../files/base64";
import { type Field, MODELS, numberAt, objectAt, refuseUnknown, WindError } from "./fields";

const FEWEST_SAMPLES = 2;
/** Ten minutes at 10 Hz. */
export const MOST_SAMPLES = 6000;
const LARGEST_COUNT = 32_767;

/** Fluctuations of a measured wind at equal intervals, quantised to 16 bits and repeated for ever. */
export interface Recording {
  readonly interval_s: number;
  /** The fluctuation that one count stands for. */
  readonly unit: number;
  /** Fluctuations along and across the wind, in counts: int16, little-endian, base64. */
  readonly pairs: string;
}

export const STILL: Recording = { interval_s: 1, unit: 0, pairs: "AAAAAAAAAAA=" };

const INTERVAL: Field = { low: 0.05, high: 3600, models: MODELS };
const UNIT: Field = { low: 0, high: 1000, models: MODELS };
const EXPECTED = `expected ${FEWEST_SAMPLES}..${MOST_SAMPLES} pairs of 16-bit integers, little-endian, in base64`;

/** Parses the field `recording`; throws WindError that names the invalid field. */
export function recordingAt(value: unknown, path: string): Recording {
  if (value === undefined || value === null) throw new WindError(path, "missing, expected an object");
  const fields = objectAt(value, path);
  refuseUnknown(fields, ["interval_s", "unit", "pairs"], path, "not a field of a recording");
  const interval_s = numberAt(fields, "interval_s", INTERVAL, path) as number;
  const unit = numberAt(fields, "unit", UNIT, path) as number;
  const { pairs } = fields;
  if (typeof pairs !== "string" || !isPairs(pairs)) throw new WindError(`${path}.pairs`, EXPECTED);
  return { interval_s, unit, pairs };
}

function isPairs(text: string): boolean {
  if (text.length % 4 !== 0 || text.length > 8 * MOST_SAMPLES || !/^[A-Za-z0-9+/]+={0,2}$/.test(text)) {
    return false;
  }
  const count = Math.floor((text.replace(/=/g, "").length * 3) / 4) / 4;
  return Number.isInteger(count) && count >= FEWEST_SAMPLES && count <= MOST_SAMPLES;
}

/** [count, 2] fluctuations along and across the wind, in standard deviations at this gustiness. */
export function fluctuations({ pairs, unit }: Recording): Float64Array {
  return Float64Array.from(new Int16Array(bytesOfBase64(pairs).buffer), (count) => count * unit);
}

/** A recording of [count, 2] fluctuations, whose largest takes the largest count. */
export function quantised(values: ArrayLike<number>, interval_s: number): Recording {
  let most = 0;
  for (let i = 0; i < values.length; i++) most = Math.max(most, Math.abs(values[i]));
  const unit = most / LARGEST_COUNT;
  const counts = new DataView(new ArrayBuffer(2 * values.length));
  for (let i = 0; i < values.length; i++) {
    counts.setInt16(2 * i, unit > 0 ? Math.floor(values[i] / unit + 0.5) : 0, true);
  }
  return { interval_s, unit, pairs: textOfBase64(new Uint8Array(counts.buffer)) };
}
