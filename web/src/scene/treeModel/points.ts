/** Points and directions as number triples, for meshes made vertex by vertex. Pure. */
export type Point = readonly [number, number, number];

/** The point at a share of the way from one to another. */
export const pointAlong = (a: Point, b: Point, share: number): Point => [
  a[0] + share * (b[0] - a[0]),
  a[1] + share * (b[1] - a[1]),
  a[2] + share * (b[2] - a[2]),
];
export const minus = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** a + factor · b. */
export const plus = (a: Point, b: Point, factor: number): Point => [
  a[0] + factor * b[0],
  a[1] + factor * b[1],
  a[2] + factor * b[2],
];
export const dot = (a: Point, b: Point) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Point, b: Point): Point => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const unit = (a: Point): Point => {
  const length = Math.hypot(a[0], a[1], a[2]) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
};
/** The direction at an angle from one to another, both of unit length and perpendicular to each other. */
export const between = (a: Point, b: Point, angle_rad: number): Point => {
  const [cosine, sine] = [Math.cos(angle_rad), Math.sin(angle_rad)];
  return [cosine * a[0] + sine * b[0], cosine * a[1] + sine * b[1], cosine * a[2] + sine * b[2]];
};
