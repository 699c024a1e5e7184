/** What the server detected in an uploaded mesh, read from its import report. Pure. */

export interface Part {
  /** Its name in the file: node, mesh or material. */
  readonly name: string;
  readonly faces: number;
  readonly wood: boolean;
  readonly reason: string;
}

export interface Assumed {
  readonly axis: { value: string; reason: string };
  readonly size: string;
  readonly height_m: number;
  readonly species: { value: string; reason: string };
  readonly parts: readonly Part[];
  readonly warnings: readonly string[];
}

type Json = Record<string, unknown>;

const object = (value: unknown): Json =>
  typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Json) : {};
const text = (value: unknown): string => (typeof value === "string" ? value : "");
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);

function partOf(value: unknown): Part {
  const part = object(value);
  const names = [...new Set(list(part.names).map(text).filter(Boolean))];
  const faces = typeof part.faces === "number" ? part.faces : 0;
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

/** Reads an import report, or the one inside a build report. */
export function assumedOf(report: unknown): Assumed {
  const all = object(report);
  const intake = "up_axis" in all ? all : object(all.import ?? all.intake);
  const [axis, unit, species] = [object(intake.up_axis), object(intake.unit), object(intake.species)];
  return {
    axis: { value: text(axis.value) || "y", reason: text(axis.reason) },
    size: text(unit.reason),
    height_m: typeof intake.height_m === "number" ? intake.height_m : 0,
    species: { value: text(species.value), reason: text(species.reason) },
    parts: together(list(intake.parts).map(partOf)),
    warnings: list(intake.warnings).map(text).filter(Boolean),
  };
}
