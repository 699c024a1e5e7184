/** Uniforms shared by trees, ground and ground cover: snow, leaves, and the light of the moment. */
import { Color } from "three";

export const seasonal = {
  /** 0: none, 1: on all surfaces that face the sky. */
  uSnow: { value: 0 },
  uSnowColour: { value: new Color(0.74, 0.79, 0.86) },
  /** Share of the leaves that are still on the trees. */
  uLeafShare: { value: 1 },
  /** Sunlight before any shadow, and sky light on level ground. */
  uSunColour: { value: new Color() },
  uSkyColour: { value: new Color() },
};
