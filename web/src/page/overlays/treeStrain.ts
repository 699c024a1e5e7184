/** The strain of a tree's wood in a steady wind, which the service computes, its colours and its words. */

import type { Foliage } from "galewood/core";
import { Color } from "three";
import { fetchApi, Problem } from "../server/api";
import type { Schemas } from "../server/schema";

/** The wind of the strain, as in field studies, m/s. */
const SHOWN_WIND_M_S = 15;
const UNSTRAINED_COLOUR = new Color(0xf4f1e6);
const MIDDLE_COLOUR = new Color(0xffb02e);
const STRAINED_COLOUR = new Color(0xd01030);

/** What the wood bears along its axes. */
export interface Bearing {
  /** xyz of the points of the axes, m, tree frame; `links` are pairs of them. */
  readonly points_m: Float32Array;
  readonly links: Uint32Array;
  /** Of each link; where none is computed, that of the link before it. */
  readonly strain: Float32Array;
  /** The largest of the stem and of boughs of 4 cm and more. */
  readonly largest: number;
  readonly words: string;
}

type Answer = Schemas["TreeStrainOut"];

/**
 * The strain of a tree in a wind that blows towards a direction of its own frame. Throws a Problem. One drawn at another
 * `scale` has the same strain, but for the share of its weight: moments and sections grow alike.
 */
export async function strainOf(
  treeId: string,
  foliage: Foliage,
  direction_deg: number,
  scale: number,
): Promise<Bearing> {
  const asked = `speed_m_s=${SHOWN_WIND_M_S}&direction_deg=${direction_deg.toFixed(0)}&foliage=${foliage}`;
  const answer = await fetchApi(`api/trees/${encodeURIComponent(treeId)}/strain?${asked}`);
  return bearingOf((await answer.json()) as Answer, foliage, scale);
}

export function bearingOf(answer: Answer, foliage: Foliage, scale = 1): Bearing {
  const { parent, largest } = answer;
  const sections = [largest.stem, largest.boughs].flatMap((one) => (one ? [one] : []));
  if (!sections.length)
    throw new Problem("This tree has no stem to speak of.", "Check its pieces and its height.");
  const most = sections.reduce((worst, one) => (one.strain > worst.strain ? one : worst));
  const place = `${most === largest.stem ? "the stem" : "a bough"} ${(scale * most.height_m).toFixed(1)} m up`;
  const at_points = new Float32Array(parent.length);
  // parents come first
  parent.forEach((above, point) => {
    at_points[point] = answer.strain[point] ?? (above < 0 ? 0 : at_points[above]);
  });
  const points = parent.flatMap((above, point) => (above < 0 ? [] : [point]));
  return {
    points_m: Float32Array.from(answer.points_m.flat()),
    links: Uint32Array.from(points.flatMap((point) => [parent[point], point])),
    strain: Float32Array.from(points, (point) => at_points[point]),
    largest: most.strain,
    words: words(answer, foliage, most.strain, place),
  };
}

const mm_m = (strain: number) => (1000 * strain).toFixed(2);

function words(
  { wind_m_s, rupture_strain, breast_height_strain, caution }: Answer,
  foliage: Foliage,
  most: number,
  place: string,
): string {
  const breast = breast_height_strain === null ? "" : ` At 1.3 m: ${mm_m(breast_height_strain)} mm/m.`;
  const wind = `Steady wind of ${wind_m_s} m/s, ${foliage === "leaf" ? "in leaf" : "bare"}.`;
  const colours = `White: no strain, red: ${mm_m(most)} mm/m, in ${place}.${breast}`;
  return `${wind} ${colours} Green wood breaks at about ${mm_m(rupture_strain)} mm/m. ${caution}`;
}

/** rgb of each link: white without strain, over orange to red at the largest, and red above. */
export function strainColours(strain: Float32Array, largest: number): Float32Array {
  const colours = new Float32Array(3 * strain.length);
  const colour = new Color();
  strain.forEach((value, link) => {
    const share = Math.min(1, value / Math.max(largest, 1e-12));
    if (share < 0.5) colour.lerpColors(UNSTRAINED_COLOUR, MIDDLE_COLOUR, 2 * share);
    else colour.lerpColors(MIDDLE_COLOUR, STRAINED_COLOUR, 2 * share - 1);
    colour.toArray(colours, 3 * link);
  });
  return colours;
}
