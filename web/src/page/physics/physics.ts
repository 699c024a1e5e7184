/** Physical properties of a tree, taken from its build report, as rows of a card. Pure. */
import type { ReportedTree, Tree } from "../server/api";
import { whole } from "../ui/words";

export interface Fact {
  readonly name: string;
  readonly value: string;
  /** Explanation for readers who do not know the term. */
  readonly meaning: string;
}

/** The number at a path of the report; null if it is missing. */
function numberAt(report: unknown, ...path: (string | number)[]): number | null {
  let at: unknown = report;
  for (const step of path) {
    if (typeof at !== "object" || at === null) return null;
    at = (at as Record<string | number, unknown>)[step];
  }
  return typeof at === "number" && Number.isFinite(at) ? at : null;
}

const percent = (share: number) => `${(100 * share).toFixed(share < 0.0995 ? 1 : 0)} %`;

export function sizeInWords(bytes: number): string {
  if (bytes < 1e6) return `${Math.round(bytes / 1e3)} kB`;
  return `${(bytes / 1e6).toFixed(1)} MB`;
}

export function timeInWords(seconds: number): string {
  return seconds < 90 ? `${seconds.toFixed(seconds < 10 ? 1 : 0)} s` : `${(seconds / 60).toFixed(1)} min`;
}

/** The facts that the build report contains; missing values are omitted. */
export function factsOf(
  { height_m, report }: Pick<Tree, "height_m"> & { readonly report: ReportedTree["report"] | null },
  tableBytes: number | null,
): Fact[] {
  const of = (...path: (string | number)[]) => numberAt(report, ...path);
  const facts: (Fact | null)[] = [
    fact("Height", height_m, (m) => `${m.toFixed(1)} m`, "From the ground to the top of the crown."),
    fact("Wood mass", of("model", "wood_mass_kg"), (kg) => `${whole(kg)} kg`, "Green wood, without leaves."),
    fact(
      "First natural frequency",
      of("model", "frequencies_hz", 0),
      (hz) => `${hz.toFixed(2)} Hz`,
      `How often it sways back and forth per second${nextFrequencies(report)}.`,
    ),
    stiffnessFact(report),
    fact(
      "First frequency without leaves",
      of("bare_table", "model", "frequencies_hz", 0),
      (hz) => `${hz.toFixed(2)} Hz`,
      "In winter the tree is lighter and sways faster.",
    ),
    fact(
      "Damping ratio",
      of("model", "damping", "shown"),
      percent,
      "Share of critical damping; it determines how fast the sway dies out.",
    ),
    fact("Finite elements", of("meshing", "tets"), whole, "Tetrahedra in the simulated wood."),
    fact("Records", of("table", "records"), whole, "Simulated states in the table, from many winds."),
    fact("Modes", of("table", "modes"), whole, "Bending shapes whose weighted sum is the motion."),
    fact("Table size", tableBytes, sizeInWords, "Downloaded by this browser to animate the tree."),
    fact(
      "Computation time",
      secondsOf(report),
      timeInWords,
      "From the mesh to the finished table, on the server.",
    ),
    fact(
      "Frequency error",
      of("model", "reference", "frequency_error"),
      percent,
      "Largest deviation of its natural frequencies from a model with quadratic elements.",
    ),
    fact(
      "Truncation error",
      shareOfHeight(of("table", "errors", "truncation_max_m"), height_m),
      (share) => `${(100 * share).toFixed(2)} % of height`,
      "Largest displacement error of any point caused by keeping only these modes, in the training winds. " +
        "Check accuracy measures the whole error, in gusts.",
    ),
    fact(
      "Wood stretch",
      of("drawn", "wood_stretch_worst"),
      (ratio) => `${Math.max(0, 100 * (ratio - 1)).toFixed(0)} %`,
      "How much longer any edge of the wood is drawn when the top sways by a fifth of the height, in a storm, or when it is pulled.",
    ),
    fact(
      "Leaf detachment",
      of("drawn", "leaves_gap"),
      (share) => `${(100 * share).toFixed(2)} % of height`,
      "Largest change of the distance between a leaf and its twig in the same poses.",
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

/** The stiffness of this tree relative to that of its wood; null if it is that of its wood. */
export function chosenStiffness(
  report: unknown,
): { factor: number; first_Hz: number; ofWood_Hz: number } | null {
  const of = (name: string) => numberAt(report, "model", "stiffness", name);
  const [factor, first_Hz, ofWood_Hz] = [of("factor"), of("first_frequency_hz"), of("of_wood_hz")];
  return factor === null || first_Hz === null || ofWood_Hz === null ? null : { factor, first_Hz, ofWood_Hz };
}

/** The changed stiffness as a sentence; empty if it is that of the wood. */
export function stiffnessInWords(report: unknown): string {
  const chosen = chosenStiffness(report);
  if (!chosen) return "";
  const [first, wood] = [chosen.first_Hz, chosen.ofWood_Hz].map((hertz) => hertz.toPrecision(2));
  const how = chosen.factor < 1 ? "softer" : "stiffer";
  return `It is made ${how} than its wood: it sways at ${first} Hz instead of ${wood} Hz.`;
}

function stiffnessFact(report: unknown): Fact | null {
  const chosen = chosenStiffness(report);
  const value = `× ${Number(chosen?.factor.toPrecision(2))}`;
  return chosen && { name: "Stiffness", value, meaning: stiffnessInWords(report) };
}

function nextFrequencies(report: unknown): string {
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
