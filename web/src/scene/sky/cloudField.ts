/** The clouds as a field on the plane of their base: the same in GLSL for the sky and here for the sunlight. Pure. */
import type { Picture } from "../textures/paint";
import { smoothstep } from "./weather";

export const CLOUD_PARS = /* glsl */ `
float cloudBody(vec2 plane) {
  vec4 wide = texture2D(uNoise, plane * 0.062 + 0.41);
  vec4 small = texture2D(uNoise, plane * 0.21 + wide.ba * 0.06);
  return 0.58 * wide.r + 0.28 * small.g + 0.14 * texture2D(uNoise, plane * 0.83 + 0.02 * small.ra).b;
}
`;

/** Body of the field at the edge of a cloud, for clouds on this share of the sky: its measured distribution. */
export const cloudEdge = (cover: number): number => 0.715 - 0.36 * cover - 0.3 * smoothstep(0.8, 1, cover);
/** Half width of the edge. */
export const EDGE_HALF_WIDTH = 0.08;

/** Position on the plane of the clouds of a direction above the horizon. */
function onClouds(direction: { x: number; y: number; z: number }, drift: { x: number; y: number }) {
  const far = 1 / (direction.y + 0.11);
  return { x: 0.8 * direction.x * far + drift.x, y: 1.2 * direction.z * far + drift.y };
}

/** Reads one channel of a tiling picture, 0 to 1, with bilinear filtering as in the shader. */
function read({ side, pixels }: Picture, x: number, y: number, channel: number): number {
  const u = (x - Math.floor(x)) * side - 0.5;
  const v = (y - Math.floor(y)) * side - 0.5;
  const [i, j] = [Math.floor(u), Math.floor(v)];
  const at = (column: number, row: number) =>
    pixels[(((row + side) % side) * side + ((column + side) % side)) * 4 + channel];
  const low = at(i, j) + (u - i) * (at(i + 1, j) - at(i, j));
  const high = at(i, j + 1) + (u - i) * (at(i + 1, j + 1) - at(i, j + 1));
  return (low + (v - j) * (high - low)) / 255;
}

/** Body of the clouds at a position, 0 to 1. */
export function cloudBody(noise: Picture, x: number, y: number): number {
  const wide = (channel: number) => read(noise, 0.062 * x + 0.41, 0.062 * y + 0.41, channel);
  const [sx, sy] = [0.21 * x + 0.06 * wide(2), 0.21 * y + 0.06 * wide(3)];
  const small = (channel: number) => read(noise, sx, sy, channel);
  const fine = read(noise, 0.83 * x + 0.02 * small(0), 0.83 * y + 0.02 * small(3), 2);
  return 0.58 * wide(0) + 0.28 * small(1) + 0.14 * fine;
}

/** How far a cloud hides the sun, 0 to 1. */
export function behindCloud(
  noise: Picture,
  sun: { x: number; y: number; z: number },
  drift: { x: number; y: number },
  cover: number,
): number {
  const { x, y } = onClouds({ ...sun, y: Math.max(0.02, sun.y) }, drift);
  const edge = cloudEdge(cover);
  return smoothstep(edge - EDGE_HALF_WIDTH, edge + EDGE_HALF_WIDTH, cloudBody(noise, x, y));
}
