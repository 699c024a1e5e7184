/** Procedural pictures of trees for the background forest: three shapes in leaf, and the same three bare. Pure. */
import { hashUnit } from "../../core/math/random";

export const CARD_SIDE = 128;
export const CARD_SHAPES = 3;

/** Half width of the crown at a height, both relative to the card; 0 outside the crown. */
const SHAPES: readonly ((height: number) => number)[] = [
  (h) => (h < 0.16 ? 0 : 0.24 * Math.sqrt(Math.max(0, 1 - ((h - 0.5) / 0.49) ** 2)) * (1.15 - 0.35 * h)),
  (h) => (h < 0.2 ? 0 : 0.47 * Math.sqrt(Math.max(0, 1 - ((h - 0.58) / 0.41) ** 2))),
  (h) => (h < 0.24 ? 0 : 0.4 * Math.sqrt(Math.max(0, 1 - ((h - 0.6) / 0.38) ** 2)) * (0.8 + 0.35 * h)),
];

export interface CardAtlas {
  readonly width: number;
  readonly height: number;
  /** Lightness, share of wood, unused, opacity. The lower row is in leaf, the upper is bare. */
  readonly pixels: Uint8Array<ArrayBuffer>;
}

class Card {
  constructor(
    private readonly atlas: CardAtlas,
    private readonly left: number,
    private readonly bottom: number,
  ) {}

  /** x from −0.5 to 0.5, y from 0 (ground) to 1, radius relative to the side. */
  disc(x: number, y: number, radius: number, light: number, wood: number): void {
    const cx = (x + 0.5) * CARD_SIDE;
    const cy = y * CARD_SIDE;
    const r = radius * CARD_SIDE;
    for (let py = Math.ceil(cy - r); py <= cy + r; py++) {
      for (let px = Math.ceil(cx - r); px <= cx + r; px++) {
        if (px < 0 || py < 0 || px >= CARD_SIDE || py >= CARD_SIDE) continue;
        if ((px - cx) ** 2 + (py - cy) ** 2 > r * r) continue;
        const at = ((this.bottom + py) * this.atlas.width + this.left + px) * 4;
        this.atlas.pixels.set([255 * light, 255 * wood, 0, 255], at);
      }
    }
  }

  limb(x: number, y: number, angle: number, length: number, thick: number, seed: number): void {
    const steps = Math.ceil(length * CARD_SIDE);
    for (let k = 0; k <= steps; k++) {
      const t = (k / steps) * length;
      const bent = angle + 0.25 * (t / length) * Math.sign(-angle);
      this.disc(x + t * Math.sin(bent), y + t * Math.cos(bent), thick * (1 - (0.4 * k) / steps), 0.5, 1);
    }
    if (length < 0.06) return;
    for (let fork = 0; fork < 3; fork++) {
      const at = (0.45 + 0.27 * fork) * length;
      const side = (fork & 1 ? 1 : -1) * (0.45 + 0.4 * hashUnit(seed, fork));
      const turned = angle + (fork === 2 ? 0.3 * side : side);
      const own = length * (0.5 + 0.16 * hashUnit(seed, fork, 5));
      this.limb(
        x + at * Math.sin(angle),
        y + at * Math.cos(angle),
        turned,
        own,
        0.62 * thick,
        seed * 3 + fork + 1,
      );
    }
  }
}

function paintCrown(card: Card, shape: number): void {
  for (let y = 0; y < 0.3; y += 0.004) card.disc(0, y, 0.014, 0.5, 1); // the trunk; branches are hidden by leaves
  const puffs = Array.from({ length: 1700 }, (_, i) => {
    const at = (channel: number) => hashUnit(90 + shape, i, channel);
    const y = 0.14 + 0.84 * at(0);
    const side = at(1) < 0.5 ? -1 : 1;
    // Ragged outline: boughs at some heights and gaps at others.
    const reach =
      0.78 +
      0.2 * Math.sin(23 * y + 2.1 * side + shape) +
      0.16 * Math.sin(57 * y - side) +
      0.22 * (at(6) - 0.5);
    const x = side * Math.sqrt(at(5)) * SHAPES[shape](y) * reach;
    // Clumps: light on top, dark in the gaps below.
    const clump = 0.5 + 0.5 * Math.sin(26 * x + 3 * shape) * Math.cos(31 * y + 9 * x);
    return { x, y, radius: 0.007 + 0.013 * at(2), light: 0.12 + 0.22 * y + 0.34 * clump + 0.3 * at(3) };
  });
  puffs.sort((a, b) => a.light - b.light);
  for (const { x, y, radius, light } of puffs) {
    if (SHAPES[shape](y) > 0) card.disc(x, y, radius, Math.min(1, light), 0);
  }
}

export function paintCards(): CardAtlas {
  const width = CARD_SHAPES * CARD_SIDE;
  const atlas = { width, height: 2 * CARD_SIDE, pixels: new Uint8Array(width * 2 * CARD_SIDE * 4) };
  for (let shape = 0; shape < CARD_SHAPES; shape++) {
    paintCrown(new Card(atlas, shape * CARD_SIDE, 0), shape);
    const bare = new Card(atlas, shape * CARD_SIDE, CARD_SIDE);
    bare.limb(0, 0, 0, shape === 0 ? 0.56 : 0.42, 0.018, 40 + shape);
  }
  return atlas;
}
