import type { LeafLook } from "./leaf-look";
import type { LeafPoint } from "./outline";

type Shape = Pick<LeafLook, "outline" | "veins">;

/** Deltoid to round with a drawn-out tip and blunt teeth, as black and Lombardy poplars have. */
export function deltoid(): Shape {
  const outline = toothed(
    [
      [0, 0],
      [0.2, -0.02],
      [0.38, 0.1],
      [0.44, 0.26],
      [0.38, 0.46],
      [0.24, 0.66],
      [0.1, 0.85],
      [0, 1],
    ],
    22,
    0.016,
  );
  return { outline, veins: pinnate([0.06, 0.2, 0.36, 0.54], 0.42, 0.2) };
}

/** Apricot: broadly ovate with a short tip and fine teeth. */
export function ovate(): Shape {
  const outline = toothed(
    [
      [0, 0],
      [0.24, 0.03],
      [0.4, 0.2],
      [0.42, 0.38],
      [0.34, 0.6],
      [0.2, 0.78],
      [0.07, 0.89],
      [0, 1],
    ],
    30,
    0.01,
  );
  return { outline, veins: pinnate([0.08, 0.22, 0.38, 0.55, 0.7], 0.38, 0.17) };
}

/** Norway maple: five lobes with long teeth. */
export function palmate(): Shape {
  const outline: LeafPoint[] = [
    [0, 0.06],
    [0.12, -0.01],
    [0.31, -0.05],
    [0.3, 0.05],
    [0.43, 0.09],
    [0.37, 0.18],
    [0.5, 0.24],
    [0.53, 0.34],
    [0.69, 0.46],
    [0.55, 0.5],
    [0.52, 0.62],
    [0.4, 0.56],
    [0.21, 0.46],
    [0.21, 0.6],
    [0.33, 0.7],
    [0.22, 0.75],
    [0.18, 0.85],
    [0.09, 0.88],
    [0, 1.03],
  ];
  const root: LeafPoint = [0, 0.06];
  const veins = [
    [root, [0.64, 0.45]],
    [root, [0.28, -0.02]],
    [
      [0, 0.42],
      [0.28, 0.69],
    ],
    [
      [0.32, 0.26],
      [0.49, 0.57],
    ],
    [
      [0.3, 0.25],
      [0.48, 0.26],
    ],
  ] as const;
  return { outline, veins };
}

/** Silver birch: a rhombus with a long tip and double teeth. */
export function rhombic(): Shape {
  const outline = toothed(
    [
      [0, 0],
      [0.16, 0.04],
      [0.34, 0.2],
      [0.39, 0.34],
      [0.28, 0.54],
      [0.15, 0.74],
      [0.05, 0.9],
      [0, 1],
    ],
    26,
    0.022,
  );
  return { outline, veins: pinnate([0.08, 0.2, 0.32, 0.45, 0.58], 0.36, 0.2) };
}

/** Beech: elliptic with a smooth, slightly wavy edge and many straight, parallel veins. */
export function elliptic(): Shape {
  const outline = toothed(
    [
      [0, 0],
      [0.14, 0.05],
      [0.28, 0.22],
      [0.33, 0.42],
      [0.29, 0.62],
      [0.18, 0.8],
      [0.07, 0.93],
      [0, 1],
    ],
    14,
    0.006,
  );
  return { outline, veins: pinnate([0.08, 0.19, 0.3, 0.41, 0.52, 0.63, 0.74], 0.32, 0.17) };
}

/** English oak: four round lobes on each side, widest above the middle. */
export function lobed(): Shape {
  const control: LeafPoint[] = [
    [0, 0],
    [0.07, 0.02],
    [0.06, 0.1],
    [0.17, 0.16],
    [0.15, 0.23],
    [0.1, 0.28],
    [0.2, 0.36],
    [0.27, 0.42],
    [0.22, 0.48],
    [0.14, 0.52],
    [0.26, 0.59],
    [0.34, 0.67],
    [0.28, 0.74],
    [0.18, 0.76],
    [0.24, 0.84],
    [0.2, 0.92],
    [0.1, 0.93],
    [0, 1],
  ];
  const outline = Array.from({ length: 69 }, (_, i) => spline(control, (i / 68) * (control.length - 1)));
  return { outline, veins: pinnate([0.06, 0.24, 0.42, 0.6], 0.24, 0.14) };
}

/** Ash: a compound leaf of four pairs of leaflets and a last one, on a thin stalk. */
export function compound(): Shape {
  const stalk = 0.012;
  const leaflets = [0.1, 0.27, 0.44, 0.61].flatMap((y): LeafPoint[] => [
    [stalk, y],
    [0.09, y - 0.01],
    [0.2, y + 0.03],
    [0.31, y + 0.1],
    [0.2, y + 0.1],
    [0.09, y + 0.065],
    [stalk, y + 0.03],
  ]);
  const last: LeafPoint[] = [
    [stalk, 0.74],
    [0.06, 0.8],
    [0.065, 0.88],
    [0.03, 0.97],
    [0, 1.02],
  ];
  const veins = [0.1, 0.27, 0.44, 0.61].map((y): [LeafPoint, LeafPoint] => [
    [0, y + 0.015],
    [0.29, y + 0.09],
  ]);
  return { outline: [[0, 0], [stalk, 0], ...leaflets, ...last], veins };
}

/** Sycamore: five broad lobes with blunt teeth. */
export function broadPalmate(): Shape {
  const outline: LeafPoint[] = [
    [0, 0.05],
    [0.1, -0.02],
    [0.27, -0.06],
    [0.4, 0.02],
    [0.36, 0.1],
    [0.52, 0.16],
    [0.55, 0.26],
    [0.66, 0.4],
    [0.58, 0.47],
    [0.6, 0.57],
    [0.46, 0.57],
    [0.36, 0.52],
    [0.27, 0.53],
    [0.34, 0.66],
    [0.29, 0.74],
    [0.22, 0.85],
    [0.12, 0.9],
    [0, 1.02],
  ];
  const root: LeafPoint = [0, 0.05];
  const veins = [
    [root, [0.6, 0.44]],
    [root, [0.35, 0]],
    [
      [0, 0.42],
      [0.28, 0.7],
    ],
    [
      [0.3, 0.25],
      [0.52, 0.54],
    ],
  ] as const;
  return { outline, veins };
}

/** Willow: narrow and long, with a drawn-out tip. */
export function lanceolate(): Shape {
  const outline = toothed(
    [
      [0, 0],
      [0.05, 0.06],
      [0.085, 0.25],
      [0.09, 0.45],
      [0.065, 0.7],
      [0.025, 0.9],
      [0, 1],
    ],
    20,
    0.002,
  );
  return { outline, veins: [] };
}

/** The needle of a conifer, of this half width relative to its length. */
export function needle(halfWidth: number): Shape {
  const outline: LeafPoint[] = [
    [0, 0],
    [0.7 * halfWidth, 0.03],
    [halfWidth, 0.3],
    [halfWidth, 0.75],
    [0.6 * halfWidth, 0.95],
    [0, 1],
  ];
  return { outline, veins: [] };
}

/** Smooths a half outline and adds small teeth. */
function toothed(control: LeafPoint[], teeth: number, depth: number): LeafPoint[] {
  const steps = teeth * 2;
  return Array.from({ length: steps + 1 }, (_, i) => {
    const [x, y] = spline(control, (i / steps) * (control.length - 1));
    const cut = i > 2 && i < steps - 2 && i % 2 === 0 ? 1 - depth / Math.max(x, 0.1) : 1;
    return [x * cut, y] as const;
  });
}

/** Catmull–Rom through the control points. */
function spline(control: LeafPoint[], t: number): [number, number] {
  const i = Math.min(Math.floor(t), control.length - 2);
  const f = t - i;
  const at = (k: number): LeafPoint => control[Math.min(Math.max(k, 0), control.length - 1)];
  const blend = (c: 0 | 1): number => {
    const [a, b, d, e] = [at(i - 1)[c], at(i)[c], at(i + 1)[c], at(i + 2)[c]];
    return b + 0.5 * f * (d - a + f * (2 * a - 5 * b + 4 * d - e + f * (3 * (b - d) + e - a)));
  };
  return [Math.max(0, blend(0)), blend(1)];
}

/** Side veins that leave the midrib at the given heights. */
function pinnate(roots: number[], reach: number, rise: number): [LeafPoint, LeafPoint][] {
  return roots.map((y) => [
    [0, y],
    [reach * (1 - 0.75 * y), y + rise],
  ]);
}
