/** Forests for WebGLRenderer. */

import { BaseForest, type ForestOptions } from "./baseForest";
import { GLSL_GRAPHICS, makerOf } from "./materials";

/**
 * Trees that sway. Add it to a scene, plant trees, and call `update` before every picture. It steps them in a worker of its
 * own.
 */
export class Forest extends BaseForest {
  constructor(options: ForestOptions) {
    super(GLSL_GRAPHICS, makerOf, options);
  }
}
