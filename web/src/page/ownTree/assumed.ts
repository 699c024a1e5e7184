/** What the server detected in an uploaded mesh, read from its import report. Pure. */

import type { Piece, PieceKind } from "./pieces";
import type { Placing } from "./split";

/** A tree of a file with several. */
export interface FoundTree {
  readonly number: number;
  /** A name in the file that no other tree has; may be empty. */
  readonly name: string;
  readonly height_m: number;
  readonly faces: number;
  readonly taken: boolean;
}

/** What was read from the cylinders of a scanned tree. */
export interface Scan {
  /** Diameter of the trunk at 1.3 m; null if the trunk is lower. */
  readonly dbh_cm: number | null;
  /** Radius below which branches were dropped. */
  readonly min_radius_mm: number;
  readonly dropped: number;
  readonly bare: boolean;
}

export interface Assumed {
  readonly axis: { value: string; reason: string; unsure: boolean };
  readonly size: string;
  /** The unit of the file; "given" or "unknown" if the height says nothing about it. */
  readonly unit: string;
  readonly height_m: number;
  readonly species: { value: string; reason: string };
  readonly pieces: readonly Piece[];
  readonly trees: readonly FoundTree[];
  /** For each drawn primitive runs of vertices: row of `pieces`, number, row, number, … */
  readonly vertexPieces: readonly (readonly number[])[];
  readonly warnings: readonly string[];
  /** What to check before the motion is computed. */
  readonly questions: readonly string[];
  /** From the coordinates of the file, y up, to those of the tree. */
  readonly placing: Placing;
  /** Why wood that the file lacks was added; null: none was. */
  readonly addedWood: string | null;
  /** Null if the file is a mesh. */
  readonly scan: Scan | null;
}

type Json = Record<string, unknown>;

const object = (value: unknown): Json =>
  typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Json) : {};
const text = (value: unknown): string => (typeof value === "string" ? value : "");
const numberIn = (value: unknown): number | null => (typeof value === "number" ? value : null);
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);

const KINDS: readonly PieceKind[] = ["wood", "twigs", "leaves", "other"];

function pieceOf(value: unknown): Piece {
  const piece = object(value);
  const names = [...new Set(list(piece.names).map(text).filter(Boolean))];
  return {
    id: text(piece.id),
    name: names[0] ?? "",
    kind: KINDS.find((kind) => kind === piece.kind) ?? "other",
    what: text(piece.what),
    reason: text(piece.reason),
    faces: numberIn(piece.faces) ?? 0,
    pieces: numberIn(piece.pieces) ?? 1,
    sure: piece.sure !== false,
    tree: numberIn(piece.tree) ?? 1,
    colour: /^#[0-9a-f]{6}$/.test(text(piece.colour)) ? text(piece.colour) : null,
    chosen: piece.chosen === true,
    ranges: list(piece.ranges).map(text).filter(Boolean),
  };
}

function treeOf(value: unknown): FoundTree {
  const tree = object(value);
  return {
    number: numberIn(tree.number) ?? 1,
    name: text(tree.name),
    height_m: numberIn(tree.height_m) ?? 0,
    faces: numberIn(tree.faces) ?? 0,
    taken: tree.taken === true,
  };
}

function placingOf(unit: Json, roots: Json): Placing {
  const [x, y, z] = list(roots.origin_in_file).map((value) => numberIn(value) ?? 0);
  return { origin: [x ?? 0, y ?? 0, z ?? 0], metresPerUnit: numberIn(unit.metres_per_unit) ?? 1 };
}

const scanOf = (qsm: Json, parts: readonly unknown[]): Scan => ({
  dbh_cm: numberIn(qsm.dbh_cm),
  min_radius_mm: numberIn(qsm.min_radius_mm) ?? 0,
  dropped: numberIn(object(qsm.dropped).thin_branches) ?? 0,
  bare: parts.every((part) => object(part).kind === "wood"),
});

/** Reads an import report, or the one inside a build report. */
export function assumedOf(report: unknown): Assumed {
  const all = object(report);
  const found = "up_axis" in all ? all : object(all.import);
  const [axis, unit, species] = [object(found.up_axis), object(found.unit), object(found.species)];
  return {
    axis: { value: text(axis.value) || "y", reason: text(axis.reason), unsure: axis.unsure === true },
    size: text(unit.reason),
    unit: text(unit.value),
    height_m: numberIn(found.height_m) ?? 0,
    species: { value: text(species.value), reason: text(species.reason) },
    pieces: list(found.pieces).map(pieceOf),
    trees: list(found.trees).map(treeOf),
    vertexPieces: list(found.vertex_pieces).map((runs) => list(runs).map((n) => numberIn(n) ?? -1)),
    warnings: list(found.warnings).map(text).filter(Boolean),
    questions: list(found.questions).map(text).filter(Boolean),
    placing: placingOf(unit, object(found.roots)),
    addedWood: "added_wood" in found ? text(object(found.added_wood).reason) : null,
    scan: "qsm" in found ? scanOf(object(found.qsm), list(found.parts)) : null,
  };
}
