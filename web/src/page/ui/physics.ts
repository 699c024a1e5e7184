/** What is known about a tree, from the report of its computation: rows for the card. Pure. */
import type { Tree } from "../server/api";

export interface Fact {
  readonly name: string;
  readonly value: string;
  /** What it means, for who has never heard of it. */
  readonly meaning: string;
}

/** A number somewhere in a report, null if it is not there. */
export function numberAt(report: unknown, ...path: (string | number)[]): number | null {
  let at: unknown = report;
  for (const step of path) {
    if (typeof at !== "object" || at === null) return null;
    at = (at as Record<string | number, unknown>)[step];
  }
  return typeof at === "number" && Number.isFinite(at) ? at : null;
}

const whole = (value: number) => Math.round(value).toLocaleString("en");
const percent = (share: number) => `${(100 * share).toFixed(share < 0.0995 ? 1 : 0)} %`;

export function sizeInWords(bytes: number): string {
  if (bytes < 1e6) return `${Math.round(bytes / 1e3)} kB`;
  return `${(bytes / 1e6).toFixed(1)} MB`;
}

export function timeInWords(seconds: number): string {
  return seconds < 90 ? `${seconds.toFixed(seconds < 10 ? 1 : 0)} s` : `${(seconds / 60).toFixed(1)} min`;
}

/** Everything that a build's report says in a line; what is missing is left out. */
export function factsOf(tree: Pick<Tree, "height_m" | "report">, tableBytes: number | null): Fact[] {
  const { report } = tree;
  const of = (...path: (string | number)[]) => numberAt(report, ...path);
  const facts: (Fact | null)[] = [
    fact("Height", tree.height_m, (m) => `${m.toFixed(1)} m`, "From the ground to the highest leaf."),
    fact(
      "Mass of the wood",
      of("model", "wood_mass_kg"),
      (kg) => `${whole(kg)} kg`,
      "Green wood, leaves apart.",
    ),
    fact(
      "Sways",
      of("model", "frequencies_hz", 0),
      (hz) => `${hz.toFixed(2)} times a second`,
      `Its slowest way of swinging to and fro${nextSways(report)}.`,
    ),
    fact(
      "Damping",
      of("model", "damping", "shown"),
      percent,
      "How much of its swing it loses each time; a share of critical.",
    ),
    fact("Finite elements", of("meshing", "tets"), whole, "Pieces of wood whose bending is computed."),
    fact("Samples", of("table", "records"), whole, "Moments of motion in the table, from many winds."),
    fact("Modes", of("table", "modes"), whole, "Shapes of bending whose mixture is the motion."),
    fact("Table", tableBytes, sizeInWords, "What this browser was sent to move this tree."),
    fact("Computed in", secondsOf(report), timeInWords, "From the mesh to the table, on this server."),
    fact(
      "Wood against exact elements",
      of("model", "reference", "frequency_error"),
      percent,
      "Largest error of its frequencies beside quadratic elements.",
    ),
    fact(
      "Left out by the modes",
      shareOfHeight(of("table", "errors", "truncation_max_m"), tree.height_m),
      (share) => `${(100 * share).toFixed(2)} % of its height`,
      "The most that any point is off because only these shapes are kept.",
    ),
  ];
  return facts.filter((found) => found !== null);
}

function fact(
  name: string,
  value: number | null,
  words: (value: number) => string,
  meaning: string,
): Fact | null {
  return value === null ? null : { name, value: words(value), meaning };
}

function nextSways(report: unknown): string {
  const next = [1, 2].map((k) => numberAt(report, "model", "frequencies_hz", k));
  const known = next.filter((hz) => hz !== null).map((hz) => hz.toFixed(2));
  return known.length > 0 ? `; the next are ${known.join(" and ")} Hz` : "";
}

function secondsOf(report: unknown): number | null {
  const total = numberAt(report, "seconds", "total");
  if (total !== null) return total;
  const seconds = (report as Record<string, unknown> | null)?.seconds;
  if (typeof seconds !== "object" || seconds === null) return null;
  const parts = Object.values(seconds).filter((value): value is number => typeof value === "number");
  return parts.length > 0 ? parts.reduce((sum, part) => sum + part, 0) : null;
}

const shareOfHeight = (metres: number | null, height_m: number | null) =>
  metres === null || !height_m ? null : metres / height_m;
