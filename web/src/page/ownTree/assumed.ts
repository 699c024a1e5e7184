/** What the server detected in an uploaded mesh, read from its import report. Pure. */

export interface Part {
  /** Its name in the file: node, mesh or material. */
  readonly name: string;
  readonly faces: number;
  readonly wood: boolean;
  readonly reason: string;
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
  readonly axis: { value: string; reason: string };
  readonly size: string;
  readonly height_m: number;
  readonly species: { value: string; reason: string };
  readonly parts: readonly Part[];
  readonly warnings: readonly string[];
  /** Null if the file is a mesh. */
  readonly scan: Scan | null;
}

type Json = Record<string, unknown>;

const object = (value: unknown): Json =>
  typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Json) : {};
const text = (value: unknown): string => (typeof value === "string" ? value : "");
const numberIn = (value: unknown): number | null => (typeof value === "number" ? value : null);
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);

function partOf(value: unknown): Part {
  const part = object(value);
  const names = [...new Set(list(part.names).map(text).filter(Boolean))];
  const faces = numberIn(part.faces) ?? 0;
  return { name: names.at(-1) ?? "", faces, wood: part.kind === "wood", reason: text(part.reason) };
}

/** Merges parts of the same name into one choice. */
function together(parts: readonly Part[]): Part[] {
  const byName = new Map<string, Part>();
  for (const part of parts) {
    const known = byName.get(part.name);
    byName.set(part.name, known ? { ...known, faces: known.faces + part.faces } : part);
  }
  return [...byName.values()];
}

const scanOf = (qsm: Json, parts: readonly Part[]): Scan => ({
  dbh_cm: numberIn(qsm.dbh_cm),
  min_radius_mm: numberIn(qsm.min_radius_mm) ?? 0,
  dropped: numberIn(object(qsm.dropped).thin_branches) ?? 0,
  bare: parts.every((part) => part.wood),
});

/** Reads an import report, or the one inside a build report. */
export function assumedOf(report: unknown): Assumed {
  const all = object(report);
  const intake = "up_axis" in all ? all : object(all.import ?? all.intake);
  const [axis, unit, species] = [object(intake.up_axis), object(intake.unit), object(intake.species)];
  const parts = together(list(intake.parts).map(partOf));
  return {
    axis: { value: text(axis.value) || "y", reason: text(axis.reason) },
    size: text(unit.reason),
    height_m: numberIn(intake.height_m) ?? 0,
    species: { value: text(species.value), reason: text(species.reason) },
    parts,
    warnings: list(intake.warnings).map(text).filter(Boolean),
    scan: "qsm" in intake ? scanOf(object(intake.qsm), parts) : null,
  };
}
