/** Stems in classes of equal numbers by one of their figures, and the colours of the classes. Pure. */
import type { StandRisk, StemRisk } from "../server/conversion";

/** From those that are worst off to those that are best off: seven of ColorBrewer's RdYlBu, which the colour-blind see. */
const CLASS_COLOURS = ["#a50026", "#e34933", "#fca55d", "#fee99d", "#d6eef6", "#87bdd9", "#313695"] as const;

interface Quantity {
  readonly words: string;
  readonly unit: string;
  /** 1: a large value is bad. −1: a small one is. */
  readonly bad: 1 | -1;
  readonly decimals: number;
  /** Infinite: more than the calculation reaches. */
  of(stem: StemRisk): number;
}

export const QUANTITIES = {
  critical: {
    words: "Critical wind",
    unit: "m/s",
    bad: -1,
    decimals: 1,
    of: (stem) => stem.critical_m_s ?? Number.POSITIVE_INFINITY,
  },
  strain: {
    words: "Largest strain",
    unit: "mm/m",
    bad: 1,
    decimals: 2,
    of: (stem) => 1000 * stem.strain,
  },
  sway: { words: "Sway", unit: "m", bad: 1, decimals: 2, of: (stem) => stem.sway_m },
  frequency: {
    words: "First frequency",
    unit: "Hz",
    bad: -1,
    decimals: 2,
    of: (stem) => stem.frequency_hz,
  },
} as const satisfies Record<string, Quantity>;

export type QuantityName = keyof typeof QUANTITIES;

/** What is said of a critical wind, in m/s, that the calculation does not reach. */
const BEYOND_WORDS = "over 100";

/** A value with its decimals, or what is known of one that is out of reach. */
export function valueWords(name: QuantityName, value: number): string {
  return Number.isFinite(value) ? value.toFixed(QUANTITIES[name].decimals) : BEYOND_WORDS;
}

export interface ColourClass {
  readonly colour: string;
  /** Values of the stems in it, from the worst to the best. */
  readonly worst: number;
  readonly best: number;
  readonly stems: number;
}

export interface Colouring {
  /** The classes that have stems, the worst first. */
  readonly classes: readonly ColourClass[];
  /** The colour of each stem, in the order of the inventory. */
  readonly colours: readonly string[];
}

/** Colours stems by a figure. Stems with the same value have the same colour. */
export function colouringOf({ stems }: Pick<StandRisk, "stems">, name: QuantityName): Colouring {
  const { of, bad }: Quantity = QUANTITIES[name];
  const values = stems.map(of);
  const order = values
    .map((_, k) => k)
    .sort((a, b) => (values[a] === values[b] ? 0 : bad * (values[b] - values[a])));
  const colours: string[] = new Array(stems.length);
  const classes: ColourClass[] = [];
  let step = 0;
  order.forEach((stem, rank) => {
    const before = rank === 0 ? null : values[order[rank - 1]];
    const value = values[stem];
    if (value !== before) step = Math.floor((rank * CLASS_COLOURS.length) / stems.length);
    const colour = CLASS_COLOURS[step];
    colours[stem] = colour;
    const last = classes.at(-1);
    if (last?.colour === colour)
      classes[classes.length - 1] = { ...last, best: value, stems: last.stems + 1 };
    else classes.push({ colour, worst: value, best: value, stems: 1 });
  });
  return { classes, colours };
}

/** "18.0 to 24.1" or, if all are equal, "18.0". */
export function classWords(name: QuantityName, { worst, best }: ColourClass): string {
  const [first, last] = [valueWords(name, worst), valueWords(name, best)];
  return first === last ? first : `${first} to ${last}`;
}
