/** Winds of a forest: a wind document, or a function of place and time. */

import { parseWind, type WindDocument } from "../wind/document";
import { WindField } from "../wind/field";
import type { Output, Places } from "../wind/frame";
import type { Moment } from "../wind/transition";

/** A point in the world, m. */
export interface Point {
  x: number;
  y: number;
  z: number;
}

/**
 * Velocity of the air (m/s, world x and z) at the top of the tree that stands at a point (m), at a time (s). The point is
 * used again for the next tree: copy what you keep. The result may be the same object every time.
 */
export type WindFunction = (
  place: Readonly<Point>,
  time_s: number,
) => { readonly x: number; readonly z: number };

export type Wind = WindDocument | WindFunction;

/** A wind that somebody else passes; throws WindError that names the field if it is a document with a mistake. */
export const checkedWind = (wind: Wind): Wind => (typeof wind === "function" ? wind : parseWind(wind));

/** What a function says of a place (m) at a time (s); throws RangeError for anything but a velocity. */
export function velocityAt(
  wind: WindFunction,
  place: Readonly<Point>,
  time_s: number,
): { x: number; z: number } {
  const velocity = wind(place, time_s);
  if (!Number.isFinite(velocity.x + velocity.z))
    throw new RangeError(
      `wind function: expected numbers x and z (m/s), not ${velocity.x} and ${velocity.z}`,
    );
  return velocity;
}

/** A wind whose speed does not grow with height, and without gusts within crowns. */
const AS_GIVEN: WindDocument = {
  version: 1,
  model: "cosine",
  mean_speed_m_s: 0,
  direction_deg: 0,
  gustiness: 0,
  convection_speed_m_s: 4,
  seed: 0,
  height_exponent: 0,
};

/** Writes velocities (m/s) at places; `x` is the array by which the caller knows a group of trees. */
export type Fill = (x: Places, z: Places, time_s: number, outX: Output, outZ: Output) => void;

/** A wind field whose velocities someone else computes. */
export class GivenWind extends WindField {
  constructor(private readonly fill: Fill) {
    super(AS_GIVEN);
  }

  override velocity(x: Places, z: Places, { time_s }: Moment, outX: Output, outZ: Output): void {
    this.fill(x, z, time_s, outX, outZ);
  }
}
