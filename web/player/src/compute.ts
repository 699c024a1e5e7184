/** Forests that are stepped by compute shaders of WebGPU, for shaders of your own. */

export { readTable } from "./core";
export type { ForestOptions, Kind, Place, TreeNodes } from "./core/forest/forest";
export type { Wind, WindFunction } from "./core/forest/givenWind";
export type { Table } from "./core/table/table";
export type { WindDocument } from "./core/wind/document";
export { PRESETS } from "./core/wind/presets";
export { ComputedForest } from "./webgpu/step/computedForest";
