/** What was understood of an inventory; the same names as in Python. */
export interface Report {
  /** What each column was taken for: its name, with the unit. */
  readonly columns: Readonly<Record<string, string>>;
  readonly rows: number;
  readonly stems: number;
  readonly skipped: number;
  readonly first_skipped: readonly Skipped[];
  /** Names without a tree of their genus. */
  readonly substitutes: readonly Substitute[];
  /** Extent from west to east. */
  readonly width_m: number;
  /** Extent from south to north. */
  readonly depth_m: number;
  readonly lowest_m: number;
  readonly highest_m: number;
  readonly per_ha: number;
  readonly estimated_heights: number;
  readonly notes: readonly string[];
}

/** A row without a tree. */
export interface Skipped {
  readonly line: number;
  readonly reason: string;
}

export interface Substitute {
  readonly name: string;
  readonly builtin: string;
  /** Empty: the name is unknown. */
  readonly genus: string;
  readonly stems: number;
}
