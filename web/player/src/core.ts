/**
 * Trees that sway, without three.js and without a browser: runs in Node, in workers and beside any engine.
 *
 * Tables and wind documents are those of Galewood (spec/formats).
 */
import { decodeWithoutRecords, type Table } from "./core/table/table";

export {
  createForest,
  Forest,
  type ForestOptions,
  jointsOf,
  type Kind,
  type Place,
  type TreeNodes,
} from "./core/forest/forest";
export type { Point, Wind, WindFunction } from "./core/forest/givenWind";
export type { Jointed } from "./core/motion/nodePose";
export { NodePose } from "./core/motion/nodePose";
export { poseStride } from "./core/motion/poseStride";
export { TableError } from "./core/table/container";
export type { Foliage, Primitive, Table, TableMetadata } from "./core/table/table";
export { parseWind, parseWindText, type Wave, type WindDocument } from "./core/wind/document";
export { WindField } from "./core/wind/field";
export { WindError, type WindModel } from "./core/wind/fields";
export { PRESETS } from "./core/wind/presets";

/** Reads a table file; throws a TableError that names the fault. */
export const readTable = (bytes: ArrayBuffer | Uint8Array): Table => decodeWithoutRecords(bytes);
