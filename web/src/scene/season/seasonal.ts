/** What a season does to every surface: uniforms that trees, ground and cover share. */
import { Color } from "three";

export const seasonal = {
  /** 0: none, 1: it lies on all that faces the sky. */
  uSnow: { value: 0 },
  uSnowColour: { value: new Color(0.74, 0.79, 0.86) },
  /** Share of the leaves that have not fallen yet. */
  uLeafShare: { value: 1 },
};
