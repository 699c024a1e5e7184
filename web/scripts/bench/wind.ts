/** Time per frame of the wind of a large forest, for each model. */
import { TICK_HZ, WIND_MODELS } from "../../player/src/core/constants";
import { hasField, type WindDocument } from "../../player/src/core/wind/document";
import { WindField } from "../../player/src/core/wind/field";
import type { WindModel } from "../../player/src/core/wind/fields";

export interface WindTiming {
  readonly median_ms: number;
  readonly worst_ms: number;
  /** The first frame, which creates the model's texture. */
  readonly prepare_ms: number;
}

const FRAME_S = 1 / TICK_HZ;
/** Streamlined exponent of most trees in leaf. */
const TREE_EXPONENT = 1.3;

/** Time (ms) to compute the pressure at every tree in one frame. */
export function benchWind(trees = 10_000, frames = 60): Record<WindModel, WindTiming> {
  const timings = WIND_MODELS.map((model) => [model, benchModel(model, trees, frames)] as const);
  return Object.fromEntries(timings) as Record<WindModel, WindTiming>;
}

function benchModel(model: WindModel, trees: number, frames: number): WindTiming {
  const wind: WindDocument = {
    version: 1,
    model,
    mean_speed_m_s: 8,
    direction_deg: 30,
    gustiness: 0.5,
    convection_speed_m_s: 8,
    seed: 1,
    ...(hasField(model, "length_scale_m") ? { length_scale_m: 20 } : {}),
  };
  const field = new WindField(wind);
  const side = Math.ceil(Math.sqrt(trees));
  const x = Float32Array.from({ length: trees }, (_, tree) => 5.7 * (tree % side) - 2.85 * side);
  const z = Float32Array.from({ length: trees }, (_, tree) => 5.9 * Math.floor(tree / side) - 2.95 * side);
  const out = [new Float32Array(trees), new Float32Array(trees)];
  const taken = Array.from({ length: frames + 1 }, (_, frame) => {
    const start = performance.now();
    field.pressure(x, z, field.at(frame * FRAME_S), out[0], out[1], TREE_EXPONENT);
    return performance.now() - start;
  });
  const [prepare_ms, ...rest] = taken;
  const sorted = rest.toSorted((a, b) => a - b);
  return { median_ms: sorted[Math.floor(rest.length / 2)], worst_ms: sorted[rest.length - 1], prepare_ms };
}
