/** The meadow, drawn by WebGLRenderer. */
import { WebGLRenderer } from "three";
import { filling } from "./meadow.js";

export { camera, scene } from "./meadow.js";
export const renderer = filling(new WebGLRenderer({ antialias: true }));
