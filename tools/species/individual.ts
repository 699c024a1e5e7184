/** Individuals of a species: its habit and proportions, with branches, height and girth of their own. */

import { BREAST_HEIGHT_M } from "../../web/player/src/core/constants";
import type { SkeletonNode } from "./growth/skeleton";
import { type GrownTree, growTree } from "./growth/tree";
import { SPECIES } from "./parameters";
import type { Species } from "./species";

/** What distinguishes an individual. */
export interface Individual {
  /** Key of the wood of the species, such as "oak". */
  species: string;
  form: Species["form"];
  /** A whole number from 0 to 2³² − 1: the branches follow from it. */
  seed: number;
  /** Height of the topmost leaf, m. */
  height_m: number;
  /** Diameter of the stem at breast height, cm; without it: in proportion to the height. */
  dbh_cm?: number | null;
  /** Whether a size that the species cannot have becomes the nearest one; otherwise it is refused. */
  nearest_size?: boolean;
}

/** An individual whose size is known, and one that its species can have. */
interface SizedIndividual extends Individual {
  dbh_cm: number;
}

/** Heights over that of the built-in tree, and girths over those that are in proportion to the height. */
const HEIGHT_RANGE = [0.4, 1.6] as const;
const GIRTH_RANGE = [0.6, 1.7] as const;
/**
 * Height over that of the tree below which no twig hangs: what lies there beside a stem looks like a stone, also to an
 * import (galewood/tree/pieces/around_trunk.py).
 */
const LOWEST_TWIG_SHARE = 0.06;
/** Multiplier of Fibonacci hashing (Knuth, The Art of Computer Programming 3, 6.4): neighbouring seeds differ in all bits. */
const SEED_FACTOR = 0x9e3779b1;

/** The built-in tree whose habit an individual has. Throws a RangeError with a sentence for people. */
export function builtinOf({ species, form }: Pick<Individual, "species" | "form">): Species {
  const found = SPECIES.find((one) => one.wood === species && one.form === form);
  if (found) return found;
  const known = [...new Set(SPECIES.map(({ wood }) => wood))].join(", ");
  throw new RangeError(
    `No species "${species}" grown in the form "${form}": choose one of ${known}; open, forest`,
  );
}

/** Grows an individual: the same values give the same tree. Throws a RangeError with a sentence for people. */
export function growIndividual(individual: Individual): GrownTree {
  const builtin = builtinOf(individual);
  const sized = ofPossibleSize(builtin, individual);
  return growTree(scaled(builtin, sized), (species, grown) => ofGirth(species, grown, sized));
}

/** Diameter of the stem of a grown tree at breast height, m. */
export function breastDiameter(nodes: readonly SkeletonNode[]): number {
  const stem = nodes.filter(({ level }) => level === 0);
  const above = Math.max(
    stem.findIndex(({ position }) => position.y >= BREAST_HEIGHT_M),
    1,
  );
  const [low, high] = [stem[above - 1], stem[above]];
  const share = (BREAST_HEIGHT_M - low.position.y) / (high.position.y - low.position.y);
  return 2 * (low.radius + (high.radius - low.radius) * share);
}

function ofPossibleSize(builtin: Species, individual: Individual): SizedIndividual {
  const { seed } = individual;
  if (!Number.isInteger(seed) || seed < 0 || seed >= 2 ** 32)
    throw new RangeError(`The seed is ${seed}: choose a whole number from 0 to ${2 ** 32 - 1}`);
  const [low_m, high_m] = HEIGHT_RANGE.map((share) => share * builtin.height_m);
  const within = (value: number, low: number, high: number): number =>
    individual.nearest_size ? Math.min(high, Math.max(low, value)) : value;
  const height_m = within(individual.height_m, low_m, high_m);
  if (!(height_m >= low_m && height_m <= high_m))
    throw new RangeError(
      `A height of ${height_m} m is out of range for ${builtin.name}: choose ${low_m.toFixed(1)} to ${high_m.toFixed(1)} m`,
    );
  const usual_cm = 200 * builtin.girth.breast_radius_m * (height_m / builtin.height_m);
  const [low_cm, high_cm] = GIRTH_RANGE.map((share) => share * usual_cm);
  const dbh_cm = within(individual.dbh_cm ?? usual_cm, low_cm, high_cm);
  if (!(dbh_cm >= low_cm && dbh_cm <= high_cm))
    throw new RangeError(
      `A diameter of ${dbh_cm} cm is out of range for ${builtin.name} of ${height_m} m: ` +
        `choose ${low_cm.toFixed(1)} to ${high_cm.toFixed(1)} cm`,
    );
  return { ...individual, height_m, dbh_cm };
}

/**
 * The species in the size of an individual. Lengths of the wood follow the height, radii the girth. Leaves and shoots
 * change less: half of what the crown grows by is more of them.
 */
function scaled(builtin: Species, { seed, height_m, dbh_cm }: SizedIndividual): Species {
  const tall = height_m / builtin.height_m;
  const thick = dbh_cm / (200 * builtin.girth.breast_radius_m);
  const { girth, twigs, foliage } = builtin;
  return {
    ...builtin,
    height_m,
    habit: { ...builtin.habit, seed: Math.imul(seed, SEED_FACTOR) >>> 0 },
    girth: {
      ...girth,
      breast_radius_m: thick * girth.breast_radius_m,
      bough_radius_m: thick * girth.bough_radius_m,
      tip_radius_m: thick * girth.tip_radius_m,
      flare_height_m: thick * girth.flare_height_m,
    },
    twigs: {
      ...twigs,
      count: Math.round(tall * twigs.count),
      length_m: twigs.length_m.map((length) => Math.sqrt(tall) * length),
      radius_m: Math.sqrt(thick) * twigs.radius_m,
      lowest_m: LOWEST_TWIG_SHARE * height_m,
    },
    foliage: {
      ...foliage,
      cards: Math.round(tall * foliage.cards),
      size_m: Math.sqrt(tall) * foliage.size_m,
    },
  };
}

/** The species with its stem corrected by what the flare of its foot and its sections add at breast height. */
function ofGirth(species: Species, { nodes }: GrownTree, { dbh_cm }: SizedIndividual): Species {
  const { girth } = species;
  const factor = dbh_cm / 100 / breastDiameter(nodes);
  return { ...species, girth: { ...girth, breast_radius_m: factor * girth.breast_radius_m } };
}
