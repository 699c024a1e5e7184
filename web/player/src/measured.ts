/** Winds from the file of an anemometer's logger: CSV with time, speed and direction, or components. */
import type { Row } from "./core/files/delimited";
import { columnsOf } from "./core/wind/measured/columns";
import { type Measurement, readMeasurement as readSamples } from "./core/wind/measured/reading";
import { readRows, type TextFile } from "./files/rows";

export type { Row } from "./core/files/delimited";
export { duration, type Measurement, MeasurementError, type Report } from "./core/wind/measured/reading";
export { readRows, type TextFile } from "./files/rows";

/** Rows in which a header is looked for. */
const LOOKED_AT = 100;

/** Whether a file, or its beginning, looks like such a measurement. */
export const isMeasurement = (file: TextFile): boolean =>
  readRows(file)
    .slice(0, LOOKED_AT)
    .some((row) => columnsOf(row) !== null);

/**
 * Reads a measurement as a wind document: at most ten minutes at 10 Hz, from `start_s` after the first sample. Takes
 * the file, or its rows to read it again from another start. Throws a MeasurementError that says what is wrong.
 */
export const readMeasurement = (file: TextFile | readonly Row[], start_s = 0): Measurement =>
  readSamples(Array.isArray(file) ? file : readRows(file as TextFile), start_s);
