/** Autumn colours: which a tree wears, and how far they replace the leaf texture's own. Pure. */
import { hashUnit } from "../math/random";

type Rgb = readonly [number, number, number];

/** Linear-light leaf colours by species; the first are the most frequent. */
const PALETTES: Record<string, readonly Rgb[]> = {
  poplar: [
    [0.62, 0.4, 0.035],
    [0.7, 0.47, 0.06],
    [0.56, 0.42, 0.05],
    [0.3, 0.38, 0.05],
  ],
  maple: [
    [0.5, 0.035, 0.02],
    [0.62, 0.09, 0.02],
    [0.42, 0.015, 0.022],
    [0.64, 0.2, 0.025],
    [0.2, 0.33, 0.035],
  ],
  apricot: [
    [0.58, 0.22, 0.05],
    [0.24, 0.34, 0.05],
    [0.6, 0.31, 0.1],
    [0.36, 0.36, 0.05],
  ],
};

const OTHER: readonly Rgb[] = [
  [0.5, 0.28, 0.05],
  [0.28, 0.33, 0.05],
  [0.45, 0.15, 0.04],
];

/** Colour (linear) and strength of the autumn tint for one tree. */
export function leafTint(species: string | null, treeId: number): [number, number, number, number] {
  const palette = (species && PALETTES[species]) || OTHER;
  const pick = Math.floor(palette.length * hashUnit(treeId, 21) ** 1.5);
  const next = palette[Math.min(palette.length - 1, pick + 1)];
  const mix = 0.45 * hashUnit(treeId, 22);
  const light = 0.85 + 0.3 * hashUnit(treeId, 23);
  const channel = (k: 0 | 1 | 2) => light * (palette[pick][k] * (1 - mix) + next[k] * mix);
  return [channel(0), channel(1), channel(2), species && PALETTES[species] ? 0.9 : 0.35];
}
