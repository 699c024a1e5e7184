/** The meadow, drawn by WebGPURenderer; `?webgl` draws with WebGL 2. */
import { WebGPURenderer } from "three/webgpu";
import { filling } from "../plain/meadow.js";

export { camera, scene } from "../plain/meadow.js";
export const renderer = filling(
  new WebGPURenderer({ antialias: true, forceWebGL: location.search === "?webgl" }),
);
