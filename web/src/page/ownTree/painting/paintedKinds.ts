/** What every piece is while pieces are painted: strokes that can be undone, and the choices that follow. Pure. */
import type { Piece, PieceChoices, PieceKind } from "../pieces";

/** The kinds that can be painted. */
export type Paint = Exclude<PieceKind, "twigs">;
export const PAINTS: readonly Paint[] = ["wood", "leaves", "other"];

/** All pieces of a file, as columns of the same length. */
export interface PieceTable {
  /** Number of the part in the file. */
  readonly part: readonly number[];
  /** Number of the piece within its part. */
  readonly number: readonly number[];
  readonly kind: readonly PieceKind[];
}

interface Stroke {
  readonly to: Paint;
  /** The rows that changed, and what they were. */
  readonly from: Map<number, PieceKind>;
}

/** Ranges of pieces, "part.first-last", for rows of the table in any order. */
export function rangesOf({ part, number }: PieceTable, rows: Iterable<number>): string[] {
  const sorted = [...rows].sort((a, b) => part[a] - part[b] || number[a] - number[b]);
  const found: { part: number; first: number; last: number }[] = [];
  for (const row of sorted) {
    const open = found.at(-1);
    if (open && open.part === part[row] && open.last + 1 === number[row]) open.last = number[row];
    else found.push({ part: part[row], first: number[row], last: number[row] });
  }
  return found.map((range) => `${range.part}.${range.first}-${range.last}`);
}

/** The rows of the table that ranges name. */
export function rowsOf({ part, number }: PieceTable, ranges: readonly string[]): number[] {
  const wanted = ranges.map((text) => text.split(/[.-]/).map(Number));
  return part.flatMap((own, row) =>
    wanted.some(([p, first, last]) => p === own && first <= number[row] && number[row] <= last) ? [row] : [],
  );
}

export class PaintedKinds {
  private readonly kinds: PieceKind[];
  private readonly done: Stroke[] = [];
  private undone: Stroke[] = [];
  private open: Stroke | null = null;

  constructor(private readonly table: PieceTable) {
    this.kinds = [...table.kind];
  }

  kindOf(row: number): PieceKind {
    return this.kinds[row];
  }

  get count(): number {
    return this.kinds.length;
  }

  /** Starts a stroke. */
  begin(to: Paint): void {
    this.end();
    this.open = { to, from: new Map() };
  }

  /** Paints pieces with the open stroke; returns the rows that changed. */
  paint(rows: Iterable<number>): number[] {
    const { open } = this;
    if (!open) return [];
    const changed = [...rows].filter((row) => row < this.count && this.kinds[row] !== open.to);
    for (const row of changed) {
      open.from.set(row, this.kinds[row]);
      this.kinds[row] = open.to;
    }
    return changed;
  }

  /** Ends the stroke. One that changed nothing is forgotten. */
  end(): void {
    if (this.open && this.open.from.size > 0) {
      this.done.push(this.open);
      this.undone = [];
    }
    this.open = null;
  }

  /** Takes the open stroke back. */
  cancel(): void {
    for (const [row, kind] of this.open?.from ?? []) this.kinds[row] = kind;
    this.open = null;
  }

  get canUndo(): boolean {
    return this.done.length > 0;
  }

  get canRedo(): boolean {
    return this.undone.length > 0;
  }

  undo(): void {
    this.end();
    const stroke = this.done.pop();
    if (!stroke) return;
    for (const [row, kind] of stroke.from) this.kinds[row] = kind;
    this.undone.push(stroke);
  }

  redo(): void {
    const stroke = this.undone.pop();
    if (!stroke) return;
    for (const row of stroke.from.keys()) this.kinds[row] = stroke.to;
    this.done.push(stroke);
  }

  /** The rows that are not what they were before the first stroke. */
  get changed(): number[] {
    return this.kinds.flatMap((kind, row) => (kind === this.table.kind[row] ? [] : [row]));
  }

  /** All choices: earlier ones of the list `pieces`, and the painted pieces one by one. */
  choices(pieces: readonly Piece[]): PieceChoices {
    const painted = new Map<number, PieceKind>();
    for (const { ranges, kind } of pieces)
      for (const row of rowsOf(this.table, ranges)) painted.set(row, kind);
    for (const row of this.changed) painted.set(row, this.kinds[row]);
    const of = (wanted: Paint) => {
      const groups = pieces.filter(
        ({ chosen, ranges, kind }) => chosen && ranges.length === 0 && kind === wanted,
      );
      const rows = [...painted].filter(([, kind]) => kind === wanted).map(([row]) => row);
      const ids = [...groups.map(({ id }) => id), ...rangesOf(this.table, rows)];
      return ids.length > 0 ? ids : null;
    };
    return { wood_parts: of("wood"), leaves: of("leaves"), drop: of("other") };
  }
}
