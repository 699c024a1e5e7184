/**
 * Text tables with separators: delimiter, and numbers as loggers write them. Pure; the rows are split by
 * `files/rows.ts`. Twin: precompute/galewood/util/delimited.py.
 */

/** Tab, semicolon or comma: the first that at least half of the first lines contain. */
const DELIMITERS = ["\t", ";", ","] as const;
const LOOKED_AT = 50;
const COMMENTS = ["#", "%", "!", "//"];
const MISSING = new Set(["", "nan", "na", "n/a", "#n/a", "null", "none", "nodata", "-", "--", "inf", "-inf"]);
/** Numbers that loggers write for a missing value. */
const SENTINELS = new Set([-999, -9999, -99999, 7999, -7999]);

/** The cells of one row, without blanks around them, and the line of the file where it begins. */
export interface Row {
  readonly line: number;
  readonly cells: readonly string[];
}

/** A cell; empty if the row is too short or the column is negative. */
export const cellAt = ({ cells }: Row, column: number): string => cells[column] ?? "";

export const isComment = ({ cells }: Row): boolean => COMMENTS.some((mark) => cells[0].startsWith(mark));

/** Text of a file: UTF-8, UTF-16 with its mark, or else Windows-1252; line ends become newlines. */
export function decoded(bytes: Uint8Array, decode: (label: string, fatal: boolean) => string): string {
  const [a, b] = bytes;
  if (a === 0xff && b === 0xfe) return newlines(decode("utf-16le", false));
  if (a === 0xfe && b === 0xff) return newlines(decode("utf-16be", false));
  try {
    return newlines(decode("utf-8", true));
  } catch {
    return newlines(decode("windows-1252", false));
  }
}

const newlines = (text: string): string => text.replace(/\r\n?/g, "\n");

export function delimiterOf(text: string): string {
  const lines = text
    .slice(0, 100_000)
    .split("\n")
    .filter((line) => line.trim() !== "")
    .slice(0, LOOKED_AT);
  const half = Math.max(lines.length, 1) / 2;
  return DELIMITERS.find((mark) => lines.filter((line) => line.includes(mark)).length >= half) ?? ",";
}

/** Cells of all rows, empty ones included, with their lines; rows without content are left out. */
export function rowsOf(cells: readonly (readonly string[])[]): Row[] {
  const rows: Row[] = [];
  let line = 1;
  for (const raw of cells) {
    const row = { line, cells: raw.map((cell) => cell.trim()) };
    line += 1 + raw.reduce((sum, cell) => sum + (cell.split("\n").length - 1), 0);
    if (row.cells.some((cell) => cell !== "")) rows.push(row);
  }
  return rows;
}

/** The number in a cell, with a point or a comma; NaN if the value is missing, null if it is no number. */
export function numberOf(cell: string): number | null {
  if (MISSING.has(cell.toLowerCase())) return Number.NaN;
  if (!/^[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?$/.test(cell)) return null;
  const number = Number(cell.replaceAll(",", "."));
  return SENTINELS.has(number) ? Number.NaN : number;
}

/** What Python's `repr` writes for a short text. */
export const quoted = (text: string): string => {
  const short = text.slice(0, 40);
  return short.includes("'") && !short.includes('"') ? `"${short}"` : `'${short.replaceAll("'", "\\'")}'`;
};
