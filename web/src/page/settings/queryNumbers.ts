/** Numbers in URL queries, with limits. Pure. */

export interface Limits {
  readonly min: number;
  readonly max: number;
  readonly step: number;
}

/** Clamps a number to the limits, and rounds it if the step is 1. */
export function clampTo({ min, max, step }: Limits, value: number): number {
  const clamped = Math.min(max, Math.max(min, value));
  return step === 1 ? Math.round(clamped) : clamped;
}

/** A parameter clamped to its limits; null if it is missing or invalid. */
export function numberFrom(query: URLSearchParams, name: string, limits: Limits): number | null {
  const text = query.get(name);
  const value = Number(text);
  if (text === null || text.trim() === "" || !Number.isFinite(value)) return null;
  return clampTo(limits, value);
}

/** Formats a number for a query. */
export const queryText = (value: number): string => String(Number(value.toFixed(4)));
