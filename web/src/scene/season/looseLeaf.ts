/** A leaf that has come off, in the air or on the ground: its shape, and shader code of its colour. */

import { BufferAttribute, BufferGeometry } from "three";

/** Stations along a stalk and a blade of length 1: place along it, half width, height of the midrib and of the edge. */
const LEAF_STATIONS = [
  [-0.75, 0.018, 0.04, 0.04],
  [-0.42, 0.13, -0.02, 0.02],
  [-0.12, 0.34, -0.04, 0.07],
  [0.22, 0.26, -0.03, 0.06],
  [0.6, 0, 0.08, 0.08],
] as const;

/** A leaf on a stalk, bent along its midrib, without a picture; its coordinates are those of a drawing of it from above. */
export function leafBlade(): BufferGeometry {
  const corners = LEAF_STATIONS.flatMap(([along, half, rib, edge]) =>
    [-half, 0, half].flatMap((across) => [across, across === 0 ? rib : edge, along]),
  );
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(corners), 3));
  const drawn = corners.filter((_, k) => k % 3 !== 1);
  geometry.setAttribute("uv", new BufferAttribute(Float32Array.from(drawn), 2));
  const quad = (a: number) => [a, a + 3, a + 1, a + 1, a + 3, a + 4];
  const stations = LEAF_STATIONS.slice(1).map((_, k) => 3 * k);
  geometry.setIndex(stations.flatMap((first) => [...quad(first), ...quad(first + 1)]));
  geometry.computeVertexNormals();
  return geometry;
}

/** Its colour at a place of the drawing: midrib, side veins, a dry edge and spots, as far as they are wider than a pixel. */
export const BLADE_GLSL = /* glsl */ `
vec3 blade(vec3 colour, vec2 place) {
  float pixel = max(fwidth(place.x), fwidth(place.y));
  float across = abs(place.x);
  float rib = 1.0 - smoothstep(0.012, 0.024 + pixel, across);
  float between = abs(fract(7.0 * (place.y - 0.8 * across)) - 0.5);
  float vein = smoothstep(0.4, 0.48, between) * (1.0 - smoothstep(0.05, 0.1, pixel));
  float spot = step(0.82, fract(43758.5453 * sin(dot(floor(place * 22.0), vec2(12.9898, 78.233)))));
  spot *= 1.0 - smoothstep(0.015, 0.04, pixel);
  float edge = smoothstep(0.15, 0.36, across + 0.25 * max(0.0, place.y));
  return colour * (1.0 + 0.5 * max(rib, 0.5 * vein)) * (1.0 - 0.25 * edge) * (1.0 - 0.3 * spot);
}
`;
