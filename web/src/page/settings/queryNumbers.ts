/** Numbers in a query, with limits. Pure. */

export interface Limits {
  readonly min: number;
  readonly max: number;
  readonly step: number;
}

/** The nearest number within the limits; a whole one where the step is 1. */
export function clampTo({ min, max, step }: Limits, value: number): number {
  const clamped = Math.min(max, Math.max(min, value));
  return step === 1 ? Math.round(clamped) : clamped;
}

/** The number of a parameter brought within its limits; null where it is missing or unreadable. */
export function numberFrom(query: URLSearchParams, name: string, limits: Limits): number | null {
  const text = query.get(name);
  const value = Number(text);
  if (text === null || text.trim() === "" || !Number.isFinite(value)) return null;
  return clampTo(limits, value);
}

/** A number as a query writes it. */
export const queryText = (value: number): string => String(Number(value.toFixed(4)));
