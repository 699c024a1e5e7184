/** TSL of what turns vertices: the same arithmetic as the GLSL of trees/nodes/nodeTexel.ts and trees/leafFlutter.ts. */
import { cos, cross, dot, exp, float, fract, inverseSqrt, max, sin, sqrt, vec3 } from "three/tsl";
import type { Node } from "three/webgpu";
import {
  AXIS_FACTOR,
  AXIS_RISE,
  HEADING_SPREAD,
  HZ_RANGE,
  HZ_SPREAD,
  LULL_MEAN,
  LULL_RAD_S,
  LULL_SPREAD,
  LULL_SWING,
  MOST_RAD,
  ONSET_M_S,
  PHASE_SPREAD,
} from "../trees/leafFlutter";

export type Float = Node<"float">;
export type Vector = Node<"vec3">;

/** A turn: unit axis times the sine of its angle, and the cosine. */
export interface Turn {
  readonly axis: Vector;
  readonly cosine: Float;
}

/** The turn of a rotation vector (half the curl of the displacement over the stretch of the link). */
export function turnOf(curl: Vector): Turn {
  const squared = dot(curl, curl).toVar();
  const axis = curl.mul(inverseSqrt(sqrt(squared.mul(squared).add(1)))).toVar();
  return { axis, cosine: sqrt(max(0, float(1).sub(dot(axis, axis)))).toVar() };
}

/** An arm, turned. */
export const turnedBy = ({ axis, cosine }: Turn, arm: Vector): Vector =>
  arm
    .mul(cosine)
    .add(cross(axis, arm))
    .add(axis.mul(dot(axis, arm).div(cosine.add(1))));

const TURN_RAD = 2 * Math.PI;

/** How far (rad) the leaf with a random number of its own is turned about its petiole, at a mean frequency (Hz), in a wind (m/s) at a time (s). */
export function leafAngle(own: Float, mean: Float, wind: Float, time: Float): Float {
  const hz = fract(own.mul(HZ_SPREAD))
    .mul(2 * HZ_RANGE)
    .add(1 - HZ_RANGE)
    .mul(mean);
  const lull = sin(time.mul(LULL_RAD_S).add(own.mul(LULL_SPREAD)))
    .mul(LULL_SWING)
    .add(LULL_MEAN);
  const amplitude = float(1)
    .sub(exp(wind.mul(-1 / ONSET_M_S)))
    .mul(MOST_RAD)
    .mul(lull);
  return amplitude.mul(sin(hz.mul(time).add(own.mul(PHASE_SPREAD)).mul(TURN_RAD)));
}

/** The axis about which it turns. */
export function leafAxis(own: Float): Vector {
  const heading = fract(own.mul(HEADING_SPREAD)).mul(TURN_RAD).toVar();
  return vec3(cos(heading), AXIS_RISE, sin(heading)).mul(AXIS_FACTOR);
}

/** An arm, turned about an axis of length 1 (Rodrigues). */
export function turnedAbout(axis: Vector, angle: Float, arm: Vector): Vector {
  const cosine = cos(angle).toVar();
  return arm
    .mul(cosine)
    .add(cross(axis, arm).mul(sin(angle)))
    .add(axis.mul(dot(axis, arm).mul(float(1).sub(cosine))));
}
