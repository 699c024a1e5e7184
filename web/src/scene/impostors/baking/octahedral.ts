/**
 * Views of an impostor: a grid on the upper hemisphere, which an octahedron maps to a square. Its rim is the horizon. After
 * Engelhardt and Dachsbacher, Octahedron Environment Maps (2008). Pure; the same in GLSL.
 */

export type Direction = readonly [number, number, number];

/** Views along each side of the square. */
export const VIEWS_PER_SIDE = 6;

/** Unit vector of the upper hemisphere (y ≥ 0) at a place of the square [-1, 1]². */
export function directionAt(u: number, v: number): Direction {
  const x = 0.5 * (u + v);
  const z = 0.5 * (u - v);
  const y = Math.max(0, 1 - Math.abs(x) - Math.abs(z));
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

/** Place in the square of a direction; those below the horizon are lifted to it. */
export function squareAt([x, y, z]: Direction): readonly [number, number] {
  const sum = Math.abs(x) + Math.max(0, y) + Math.abs(z);
  return [(x + z) / sum, (x - z) / sum];
}

/** Direction towards the eye of one view. */
export function viewDirection(column: number, row: number): Direction {
  return directionAt((2 * column) / (VIEWS_PER_SIDE - 1) - 1, (2 * row) / (VIEWS_PER_SIDE - 1) - 1);
}

export interface WeightedView {
  readonly column: number;
  readonly row: number;
  readonly weight: number;
}

/** The three views around a direction; their weights sum to 1 and change continuously with the direction. */
export function viewsAround(direction: Direction): readonly WeightedView[] {
  const at = squareAt(direction).map((s) => (0.5 * s + 0.5) * (VIEWS_PER_SIDE - 1));
  const [column, row] = at.map((s) => Math.min(VIEWS_PER_SIDE - 2, Math.floor(s)));
  const [f, g] = [at[0] - column, at[1] - row];
  const low = f + g < 1;
  return [
    low ? { column, row, weight: 1 - f - g } : { column: column + 1, row: row + 1, weight: f + g - 1 },
    { column: column + 1, row, weight: low ? f : 1 - g },
    { column, row: row + 1, weight: low ? g : 1 - f },
  ];
}

/** Horizontal axis and vertical axis of the picture seen from a direction; the zenith itself is not a view. */
export function pictureAxes([x, y, z]: Direction): { right: Direction; up: Direction } {
  const flat = Math.hypot(x, z) || 1;
  const right: Direction = [z / flat, 0, -x / flat];
  return { right, up: [y * right[2], z * right[0] - x * right[2], -y * right[0]] };
}

/** `cornerOf`: the lower left view of the cell of a direction, and the place in it. `viewAt`: direction of a view. */
export const OCTAHEDRAL_GLSL = /* glsl */ `
const float VIEWS = ${VIEWS_PER_SIDE.toFixed(1)};
vec4 cornerOf(vec3 direction) {
  vec3 d = vec3(direction.x, max(0.0, direction.y), direction.z);
  d /= abs(d.x) + d.y + abs(d.z);
  vec2 at = (0.5 * vec2(d.x + d.z, d.x - d.z) + 0.5) * (VIEWS - 1.0);
  vec2 corner = clamp(floor(at), vec2(0.0), vec2(VIEWS - 2.0));
  return vec4(corner, at - corner);
}
vec3 viewAt(vec2 view) {
  vec2 s = 2.0 * view / (VIEWS - 1.0) - 1.0;
  vec3 d = vec3(0.5 * (s.x + s.y), 0.0, 0.5 * (s.x - s.y));
  d.y = max(0.0, 1.0 - abs(d.x) - abs(d.z));
  return normalize(d);
}
/**
 * One of the three views around a direction; chance is uniform in 0..1. Their weights are sharpened, so that most trees show
 * a single picture, and those between two of them a mixture of pixels.
 */
vec2 chooseView(vec4 corner, float chance) {
  vec2 f = corner.zw;
  bool low = f.x + f.y < 1.0;
  vec3 weight = low ? vec3(1.0 - f.x - f.y, f.x, f.y) : vec3(f.x + f.y - 1.0, 1.0 - f.y, 1.0 - f.x);
  weight *= weight;
  weight *= weight;
  chance *= weight.x + weight.y + weight.z;
  if (chance < weight.x) return corner.xy + (low ? vec2(0.0) : vec2(1.0));
  return corner.xy + (chance < weight.x + weight.y ? vec2(1.0, 0.0) : vec2(0.0, 1.0));
}
`;
