/** One result of the benchmark, and a table of results. */

export interface Figure {
  readonly name: string;
  readonly value: number;
  readonly unit: string;
  /** Upper limit of the figure. */
  readonly most?: number;
  /** The samples; the figure is their median. */
  readonly all?: readonly number[];
}

const round = (value: number) => Number(value.toPrecision(3));

export function median(values: readonly number[]): number {
  const sorted = values.toSorted((a, b) => a - b);
  return sorted.length === 0 ? Number.NaN : sorted[Math.floor(sorted.length / 2)];
}

export function printTable(figures: readonly Figure[]): void {
  const width = Math.max(...figures.map(({ name }) => name.length));
  for (const { name, value, unit, most } of figures) {
    const target = most === undefined ? "" : `(at most ${most}${value > most ? ": MISSED" : ""})`;
    console.log(`${name.padEnd(width)}  ${String(round(value)).padStart(8)} ${unit.padEnd(9)} ${target}`);
  }
}
