/** Fields of a wind document: ranges, errors and reading of single values. */

import type { WIND_MODELS } from "../constants";

export type WindModel = (typeof WIND_MODELS)[number];

/** Error in a wind document, with the path of the field and what is expected there. */
export class WindError extends Error {
  override readonly name = "WindError";

  constructor(
    readonly path: string,
    readonly expected: string,
    found: unknown = undefined,
  ) {
    super(`${path}: ${expected}${found === undefined ? "" : `, not ${String(found).slice(0, 40)}`}`);
  }
}

export interface Field {
  readonly low: number;
  readonly high: number;
  /** If absent, all models have the field. */
  readonly models?: readonly WindModel[];
  /** If absent, the field is required. */
  readonly default?: number;
  readonly whole?: boolean;
}

export function objectAt(value: unknown, path: string): Record<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    throw new WindError(path, "expected an object");
  }
  return value as Record<string, unknown>;
}

export function refuseUnknown(
  fields: Record<string, unknown>,
  known: readonly string[],
  path: string,
  why: string,
): void {
  for (const name of Object.keys(fields)) {
    if (!known.includes(name)) throw new WindError(`${path}.${name.slice(0, 40)}`, why);
  }
}

export function numberAt(
  fields: Record<string, unknown>,
  name: string,
  { low, high, default: standard, whole }: Field,
  path: string,
): number | undefined {
  const expected = `expected ${whole ? "a whole number" : "a number"} in ${low}..${high}`;
  if (fields[name] === undefined) {
    if (standard === undefined) throw new WindError(`${path}.${name}`, `missing, ${expected}`);
    return undefined;
  }
  const value = fields[name];
  const fits = typeof value === "number" && value >= low && value <= high; // NaN fails too
  if (!fits || (whole && !Number.isInteger(value))) throw new WindError(`${path}.${name}`, expected, value);
  return value;
}
