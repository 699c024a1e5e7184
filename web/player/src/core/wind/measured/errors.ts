/** A file that is no usable measurement: what is wrong, where, and what to do. */
export class MeasurementError extends Error {
  override readonly name = "MeasurementError";
}

/** The error at a line and a column. */
export const errorAt = (line: number, column: string, what: string): MeasurementError =>
  new MeasurementError(`line ${line}, column '${column}': ${what}`);
