/** One figure of the bench, and a table of them. */

export interface Figure {
  readonly name: string;
  readonly value: number;
  readonly unit: string;
  /** The figure should not be above this. */
  readonly most?: number;
  /** Every value that the figure is the median of. */
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
