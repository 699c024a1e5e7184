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
