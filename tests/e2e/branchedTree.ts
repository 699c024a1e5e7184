/** A small branched tree as an OBJ file: a tapering trunk and six branches, each a separate closed tube. */

type Point = readonly [number, number, number];

const SIDES = 7;

const lerp = (a: Point, b: Point, t: number): Point => [
  a[0] + t * (b[0] - a[0]),
  a[1] + t * (b[1] - a[1]),
  a[2] + t * (b[2] - a[2]),
];

class Obj {
  private readonly lines: string[] = [];
  private vertices = 0;

  private vertex([x, y, z]: Point): number {
    this.lines.push(`v ${x.toFixed(5)} ${y.toFixed(5)} ${z.toFixed(5)}`);
    return ++this.vertices;
  }

  private ring(centre: Point, radius: number, u: Point, w: Point): number[] {
    return Array.from({ length: SIDES }, (_, k) => {
      const c = radius * Math.cos((2 * Math.PI * k) / SIDES);
      const s = radius * Math.sin((2 * Math.PI * k) / SIDES);
      return this.vertex([
        centre[0] + c * u[0] + s * w[0],
        centre[1] + c * u[1] + s * w[1],
        centre[2] + c * u[2] + s * w[2],
      ]);
    });
  }

  tube(from: Point, to: Point, thick: number, thin: number, rings: number): void {
    const [u, w] = frame(from, to);
    const at = (t: number) => this.ring(lerp(from, to, t), thick + t * (thin - thick), u, w);
    const all = Array.from({ length: rings }, (_, i) => at(i / (rings - 1)));
    const foot = this.vertex(from);
    const tip = this.vertex(to);
    for (let k = 0; k < SIDES; k++) {
      const next = (k + 1) % SIDES;
      this.lines.push(`f ${foot} ${all[0][next]} ${all[0][k]}`, `f ${tip} ${all[rings - 1][k]} ${all[rings - 1][next]}`);
      for (let i = 1; i < rings; i++) {
        this.lines.push(`f ${all[i - 1][k]} ${all[i - 1][next]} ${all[i][next]} ${all[i][k]}`);
      }
    }
  }

  toString(): string {
    return `${this.lines.join("\n")}\n`;
  }
}

/** Two unit vectors perpendicular to the axis, oriented so that the faces of the tube point outwards. */
function frame(from: Point, to: Point): [Point, Point] {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  const d: Point = [(to[0] - from[0]) / length, (to[1] - from[1]) / length, (to[2] - from[2]) / length];
  const side: Point = Math.abs(d[1]) > 0.9 ? [1, 0, 0] : [0, 1, 0];
  const across = cross(side, d);
  const size = Math.hypot(...across);
  const u: Point = [across[0] / size, across[1] / size, across[2] / size];
  return [u, cross(d, u)];
}

const cross = (a: Point, b: Point): Point => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

export function branchedTree(): string {
  const obj = new Obj();
  obj.tube([0, 0, 0], [0.1, 7, 0.05], 0.24, 0.06, 15);
  for (let k = 0; k < 6; k++) {
    const y = 2.4 + 0.65 * k;
    const angle = 2.4 * k;
    const reach = 2.1 - 0.2 * k;
    const from: Point = [(0.1 * y) / 7, y, (0.05 * y) / 7];
    obj.tube(from, [from[0] + reach * Math.cos(angle), y + 1.1, from[2] + reach * Math.sin(angle)], 0.09, 0.035, 6);
  }
  return obj.toString();
}
