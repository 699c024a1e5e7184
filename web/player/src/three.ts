/** Forests of swaying trees for three.js. */

export type { Wind, WindFunction } from "./core/forest/givenWind";
export type { WindDocument } from "./core/wind/document";
export { PRESETS } from "./core/wind/presets";
export type { ForestOptions, Pick, TreeFiles } from "./three/baseForest";
export { Forest } from "./three/forest";
export type { MaterialFactory } from "./three/ownMaterial";
export type { Planted } from "./three/planted";
export { type ServedTree, servedTrees } from "./three/served";
export type { ViewOptions } from "./three/view";
