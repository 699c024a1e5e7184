/** The pieces of an uploaded tree as a list: what each is, why, and a choice to change it. */
import { make } from "../ui/dom";
import { whole } from "../ui/words";

/** "other" is left out. */
export type PieceKind = "wood" | "twigs" | "leaves" | "other";

/** How pieces are drawn and listed; what is left out is red. */
export const KIND_COLOURS: Readonly<Record<PieceKind, string>> = {
  wood: "#c08a55",
  twigs: "#96663c",
  leaves: "#7fb061",
  other: "#d9402f",
};

/** A square in the colour of a kind. */
export function swatchOf(kind: PieceKind): HTMLElement {
  const swatch = make("span", "", "own-tree-swatch");
  swatch.style.background = KIND_COLOURS[kind];
  swatch.setAttribute("aria-hidden", "true");
  return swatch;
}

/** A group of connected pieces, as detected or as chosen. */
export interface Piece {
  readonly id: string;
  readonly name: string;
  readonly kind: PieceKind;
  /** What it is, if it is left out: "ground", "pot", … */
  readonly what: string;
  readonly reason: string;
  readonly faces: number;
  readonly pieces: number;
  readonly sure: boolean;
  /** Number of its tree; 0: of none. */
  readonly tree: number;
  /** #rrggbb, or null if the file has none. */
  readonly colour: string | null;
  readonly chosen: boolean;
  /** Its pieces as ranges, if they were painted one by one; empty for a whole group. */
  readonly ranges: readonly string[];
}

/** The choices as the server takes them; null: as detected. */
export interface PieceChoices {
  wood_parts: string[] | null;
  leaves: string[] | null;
  drop: string[] | null;
}

const WORDS: Record<PieceKind, string> = {
  wood: "Wood",
  twigs: "Thin twigs",
  leaves: "Leaves",
  other: "Leave out",
};

/** All choices after one more. Twigs cannot be chosen: that restores what was detected. Pure. */
export function choicesWith(pieces: readonly Piece[], id: string, kind: PieceKind): PieceChoices {
  const of = (wanted: PieceKind) => {
    const ids = pieces.flatMap((piece) => {
      const found = piece.id === id ? kind : piece.chosen ? piece.kind : null;
      if (found !== wanted) return [];
      return piece.ranges.length > 0 ? piece.ranges : [piece.id];
    });
    return ids.length > 0 ? ids : null;
  };
  return { wood_parts: of("wood"), leaves: of("leaves"), drop: of("other") };
}

export const AS_DETECTED: PieceChoices = { wood_parts: null, leaves: null, drop: null };

/** What a piece is called. Pure. */
export function titleOf({ what, name, kind, pieces }: Piece): string {
  const named = what || name || (kind === "other" ? "object" : kind);
  const capital = named.charAt(0).toUpperCase() + named.slice(1);
  return pieces > 1 ? `${capital} (${whole(pieces)} pieces)` : capital;
}

/** The row of each vertex from runs of vertices (row, number, row, number, …). Pure. */
export function rowsOfVertices(runs: readonly number[], vertices: number): Int32Array {
  const rows = new Int32Array(vertices).fill(-1);
  for (let k = 0, v = 0; k + 1 < runs.length; v += runs[k + 1], k += 2)
    rows.fill(runs[k], v, v + runs[k + 1]);
  return rows;
}

export class PieceList {
  readonly root = make("fieldset", "", "own-tree-pieces");
  private rows: HTMLElement[] = [];

  /**
   * `choose` is called with the new choices, `point` with the row that is pointed at, null if none is.
   * Rows are numbered like the pieces that were detected.
   */
  constructor(
    private readonly choose: (choices: PieceChoices) => void,
    private readonly point: (row: number | null) => void,
  ) {}

  /** Shows the pieces of the chosen tree and what belongs to none. */
  show(pieces: readonly Piece[], tree: number): void {
    const list = make("ul");
    this.rows = pieces.map((piece, row) => this.row(piece, row, pieces));
    list.append(...this.rows.filter((_, row) => pieces[row].tree === 0 || pieces[row].tree === tree));
    const legend = make("legend", "Detected pieces");
    const hint = make("small", "Click a piece in the picture to find it in this list.", "own-tree-hint");
    this.root.replaceChildren(legend, hint, list);
    if (pieces.some(({ chosen }) => chosen)) this.root.append(this.reset());
  }

  /** Moves to a row, because its piece was clicked in the picture. */
  focus(row: number): void {
    const found = this.rows[row];
    found?.scrollIntoView({ block: "nearest" });
    found?.querySelector("select")?.focus();
  }

  private reset(): HTMLElement {
    const button = make("button", "Reset to detected");
    button.type = "button";
    button.addEventListener("click", () => this.choose(AS_DETECTED));
    return button;
  }

  private row(piece: Piece, row: number, all: readonly Piece[]): HTMLElement {
    const made = make("li");
    const swatch = swatchOf(piece.kind);
    if (piece.colour) swatch.style.background = piece.colour;
    const unsure = piece.sure || piece.chosen ? "" : "Unsure: please check. ";
    const about = make("span", "", "own-tree-about");
    const faces = `${whole(piece.faces)} faces; `;
    about.append(make("span", titleOf(piece)), make("small", `${unsure}${faces}${piece.reason}`));
    made.classList.toggle("unsure", unsure !== "");
    made.append(swatch, about, this.kinds(piece, all));
    made.addEventListener("pointerenter", () => this.point(row));
    made.addEventListener("pointerleave", () => this.point(null));
    made.addEventListener("focusin", () => this.point(row));
    made.addEventListener("focusout", () => this.point(null));
    return made;
  }

  private kinds(piece: Piece, all: readonly Piece[]): HTMLSelectElement {
    const made = make("select");
    made.setAttribute("aria-label", `What ${titleOf(piece)} is`);
    for (const kind of ["wood", "twigs", "leaves", "other"] as const) {
      if (kind === "twigs" && piece.kind !== "twigs") continue;
      const option = make("option", WORDS[kind]);
      option.value = kind;
      made.append(option);
    }
    made.value = piece.kind;
    made.addEventListener("change", () => this.choose(choicesWith(all, piece.id, made.value as PieceKind)));
    return made;
  }
}
