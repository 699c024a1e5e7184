/** Forests for WebGPURenderer. */
import { BaseForest, type ForestOptions } from "../three/baseForest";
import { makerOf } from "./materials";
import { TSL_GRAPHICS } from "./nodePass";

/**
 * Trees that sway, drawn by WebGPURenderer with WebGPU or WebGL 2. Add it to a scene, plant trees, and call `update` before
 * every picture. It steps them in a worker of its own.
 */
export class Forest extends BaseForest {
  constructor(options: ForestOptions) {
    super(TSL_GRAPHICS, makerOf, options);
  }
}
