/** What is said of a stem in wind. Pure. */
import type { StemRisk } from "../server/conversion";
import { capital } from "../ui/words";
import { valueWords } from "./colourScale";

const gust = (speed_m_s: number | null) => valueWords("critical", speed_m_s ?? Number.POSITIVE_INFINITY);

/** "Rotbuche, line 12". */
export const stemName = ({ species, line }: Pick<StemRisk, "species" | "line">): string =>
  `${species || "Unknown species"}, line ${line}`;

/** "maple-forest" → "Maple, forest-grown". */
const treeWords = (tree: string): string =>
  tree.endsWith("-forest")
    ? `${capital(tree.replace("-forest", ""))}, forest-grown`
    : `${capital(tree)}, open-grown`;

/** The figures of a stem as rows of label and value; `stems`: how many there are; `speed_m_s`: of the gust. */
export function stemFigures(stem: StemRisk, stems: number, speed_m_s: number): [string, string][] {
  const { critical_low_m_s: low, critical_high_m_s: high } = stem;
  const estimated = (is: boolean) => (is ? " *" : "");
  return [
    ["Breaks at", `${gust(stem.critical_m_s)} m/s`],
    ["10 to 90 %", `${gust(low)} to ${gust(high)} m/s`],
    ["Rank", `${stem.rank} of ${stems}`],
    [`Sway at ${speed_m_s} m/s`, `${stem.sway_m.toFixed(2)} m`],
    ["Largest strain", `${(1000 * stem.strain).toFixed(2)} mm/m`],
    ["Moment at the ground", `${Number(stem.base_moment_knm.toPrecision(3))} kN·m`],
    ["First frequency", `${stem.frequency_hz.toFixed(2)} Hz`],
    ["Load", `${Math.round(100 * stem.load_share)} % of that at the edge`],
    ["From the edge", `${stem.edge_distance_m.toFixed(0)} m`],
    ["Height", `${stem.height_m.toFixed(1)} m${estimated(stem.height_estimated)}`],
    ["Diameter at 1.3 m", `${stem.dbh_cm.toFixed(1)} cm${estimated(stem.dbh_assumed)}`],
    ["Tree used", treeWords(stem.tree)],
    ["Wood", stem.wood === "default" ? "average" : stem.wood],
  ];
}

/** What is to be known of the figures of a stem: what is not measured, or rough. */
export function stemMarks(stem: StemRisk, speed_m_s: number): string[] {
  const { critical_m_s, height_estimated, dbh_assumed, wood, rough } = stem;
  const breaks = critical_m_s !== null && critical_m_s <= speed_m_s;
  const marks: [boolean, string][] = [
    [
      breaks,
      `It breaks below ${speed_m_s} m/s: sway, strain and moment are what they would be if it did not.`,
    ],
    [height_estimated, "* The height is not measured: it is estimated from the diameter."],
    [dbh_assumed, "* The diameter is not measured: it has the proportions of the tree used."],
    [wood === "default", "The wood of this species is not known here: average wood."],
    [rough, "Less than half or more than twice as high, or as slender, as the tree used: rough figures."],
  ];
  return marks.flatMap(([holds, words]) => (holds ? [words] : []));
}
