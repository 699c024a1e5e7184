/**
 * The lean of a tree: stems of a forest are not parallel. It follows from the tree's place, and shears the tree, whose foot and
 * heights stay. The motion is that of the upright tree. Pure.
 */

/** Largest horizontal way per metre of height: about 3°; the root mean square is about half. */
export const MOST_LEAN = 0.05;
/** Wave numbers (rad/m) of the two waves whose sum is the lean; the second is weaker and shorter. */
const LEAN_WAVES = [2.31, 1.17, -1.73, 2.89] as const;
const SECOND_WEIGHT = 0.6;
const SECOND_SCALE = 2.7;
const SECOND_PHASE_RAD = 1.3;
const LEAN_FACTOR = MOST_LEAN / (Math.SQRT2 * (1 + SECOND_WEIGHT));

/** Horizontal way (x, z) per metre of height of a tree at a place. */
export function leanOf(x_m: number, z_m: number): readonly [number, number] {
  const [a, b, c, d] = LEAN_WAVES;
  const [first, second] = [a * x_m + b * z_m, c * x_m + d * z_m];
  const wave = (own: number, other: number) =>
    LEAN_FACTOR * (Math.sin(own) + SECOND_WEIGHT * Math.sin(SECOND_SCALE * other + SECOND_PHASE_RAD));
  return [wave(first, second), wave(second, first)];
}

/** GLSL: the same. */
export const LEAN_SHADER = /* glsl */ `
vec2 leanOf(vec2 place) {
  vec2 waves = vec2(dot(place, vec2(${LEAN_WAVES[0]}, ${LEAN_WAVES[1]})), dot(place, vec2(${LEAN_WAVES[2]}, ${LEAN_WAVES[3]})));
  return ${LEAN_FACTOR} * (sin(waves) + ${SECOND_WEIGHT} * sin(${SECOND_SCALE} * waves.yx + ${SECOND_PHASE_RAD}));
}
`;
