/**
 * Reader of the table format: one safetensors file per species, with or without records (spec/formats/table.md).
 * Everything is validated here, so that a decoded table can be used without bounds checks.
 */

import {
  MAX_DRAG_POINTS,
  MAX_MODES,
  MAX_OSCILLATORS,
  MAX_PLACES,
  RECORD_TENSORS,
  TABLE_FORMAT,
  TABLE_RANGES,
  TABLE_TENSORS,
  TABLE_VERSION,
} from "../constants";
import { contracts, coupledOf, forceTerms, type ModalTensors, poseTerms } from "../modal/modalTensors";
import {
  brief,
  checkFilled,
  checkFinite,
  checkFormat,
  checkShapes,
  type Json,
  need,
  number,
  object,
  readContainer,
  readTensors,
  refuseUnknown,
  shapeOf,
  type Tensors,
  valuesOf,
  whole,
} from "./container";
import { type Records, readRecords } from "./records";

export { TableError } from "./container";

/** Whether a tree has its leaves: a bare tree has only the mass and the wind area of its wood. */
export type Foliage = "leaf" | "bare";

export interface Primitive {
  readonly name: string;
  readonly kind: string;
  readonly vertices: number;
}

export interface TableMetadata {
  readonly species: string;
  readonly height_m: number;
  readonly dt_s: number;
  readonly modes: number;
  readonly primitives: readonly Primitive[];
  readonly design_speed_m_s: number;
  /** Power of the wind speed with which the pressure on the tree grows above 5 m/s. */
  readonly streamlined_exponent: number;
  /** Largest dynamic pressure of the winds that the table was made from. */
  readonly peak_pressure_pa: number;
  /** Largest displacement of any part of the tree, with a margin. */
  readonly reach_m: number;
  readonly mesh_sha256: string;
  /** Without it: in leaf. */
  readonly foliage?: Foliage;
  readonly [more: string]: unknown;
}

/** A decoded table: r modes, n nodes, j joints. Units in spec/formats/table.md. */
export interface Table {
  readonly metadata: TableMetadata;
  /** [r] metres of q per integer step */
  readonly modeScale: Float32Array;
  /** [n, 3, r] metres per unit of q */
  readonly nodeBasis: Float32Array;
  /** [n, 3] */
  readonly nodeRest: Float32Array;
  /** [n, 3, r] rotation vector per unit of q */
  readonly nodeTurn: Float32Array;
  /** [n] node before it on its branch, never a later one; its own index: none */
  readonly nodeParent: Uint16Array;
  /** [j, 2] the two nodes of each joint, [j] share of the second, [j, 3] rest position */
  readonly jointNodes: Uint16Array;
  readonly jointShare: Float32Array;
  readonly jointRest: Float32Array;
  /** joint of each render vertex, primitives concatenated */
  readonly vertexJoint: Uint16Array;
  /** the nearer node of each render vertex */
  readonly vertexNode: Uint16Array;
  readonly modal: ModalTensors;
  /** Records of the paper's state search, if the file holds them. */
  readonly paper: Records | null;
}

/** Decodes a table file. Throws TableError that names the fault. */
export const decodeTable = (file: ArrayBuffer | Uint8Array): Table => decode(file, readRecords);

/** Decodes a table file without its records, so that their reader need not be bundled. Throws TableError. */
export const decodeWithoutRecords = (file: ArrayBuffer | Uint8Array): Table => decode(file, () => null);

function decode(
  file: ArrayBuffer | Uint8Array,
  recordsOf: (metadata: unknown, tensors: Tensors, modes: number) => Records | null,
): Table {
  const container = readContainer(file);
  checkFormat(container.metadata, TABLE_FORMAT, TABLE_VERSION);
  const { paper = null, ...given } = container.metadata;
  const recorded = Object.keys(container.header).some((name) => Object.hasOwn(RECORD_TENSORS, name));
  need(!recorded || paper !== null, "metadata paper: missing");
  const metadata = checkMetadata(given);
  const layout = { ...TABLE_TENSORS, ...(paper === null ? {} : RECORD_TENSORS) };
  const tensors = readTensors(container, layout);
  refuseUnknown(container.header, layout);
  checkFilled(container);
  checkTableShapes(tensors, metadata);
  checkFinite(tensors);
  const records = paper === null ? null : recordsOf(paper, tensors, metadata.modes);
  const table = assemble(tensors, metadata, records);
  checkNumbers(table);
  return table;
}

function assemble(tensors: Tensors, metadata: TableMetadata, paper: Records | null): Table {
  const values = (name: string) => valuesOf(tensors, name);
  const jointNodes: Uint16Array = values("joints.nodes");
  const jointShare: Float32Array = values("joints.share");
  const vertexJoint: Uint16Array = values("render.vertex_joint");
  return {
    metadata,
    modeScale: values("modes.scale"),
    nodeBasis: values("nodes.basis"),
    nodeRest: values("nodes.rest_m"),
    nodeTurn: values("nodes.turn"),
    nodeParent: values("nodes.parent"),
    jointNodes,
    jointShare,
    jointRest: values("joints.rest_m"),
    vertexJoint,
    vertexNode: vertexJoint.map((joint) => jointNodes[2 * joint + (jointShare[joint] > 0.5 ? 1 : 0)]),
    modal: {
      step: values("modal.step"),
      load: values("modal.load"),
      sway: values("modal.sway"),
      force: values("modal.force"),
      shown: values("modal.shown"),
      pose: values("modal.pose"),
      limits: values("modal.limits"),
      dragPoint: values("modal.drag_point"),
      dragShape: values("modal.drag_shape"),
      dragRest: values("modal.drag_rest"),
      dragPlace: values("modal.drag_place"),
      place: values("modal.place"),
      placeLoad: values("modal.place_load"),
      streamlinedExponent: metadata.streamlined_exponent,
    },
    paper,
  };
}

function checkMetadata(metadata: Json): TableMetadata {
  for (const [name, [low, high]] of Object.entries(TABLE_RANGES)) number(metadata, name, low, high);
  whole(metadata, "modes", MAX_MODES);
  const { foliage = "leaf" } = metadata;
  need(
    foliage === "leaf" || foliage === "bare",
    `metadata foliage: expected 'leaf' or 'bare', not ${brief(foliage)}`,
  );
  need(Array.isArray(metadata.primitives), "metadata primitives: expected a list");
  for (const primitive of metadata.primitives) {
    number(object(primitive, "metadata primitives: expected objects"), "vertices", 0, 2 ** 31);
  }
  return metadata as unknown as TableMetadata;
}

function checkTableShapes(tensors: Tensors, { modes, primitives }: TableMetadata): void {
  const n = shapeOf(tensors, "nodes.rest_m")[0];
  const j = shapeOf(tensors, "joints.share")[0];
  const vertices = primitives.reduce((sum, primitive) => sum + Math.trunc(primitive.vertices), 0);
  const d = shapeOf(tensors, "modal.step")[0];
  const most = Math.min(MAX_OSCILLATORS, modes);
  need(d >= 2 && d <= most, `tensor modal.step: expected 2..${most} rows`);
  const c = coupledOf(shapeOf(tensors, "modal.limits")[0] ?? 0);
  need(
    Number.isInteger(c) && c >= 0 && c <= d - 2,
    `tensor modal.limits: expected 3, 5, … ${2 * d - 1} numbers`,
  );
  const m = shapeOf(tensors, "modal.drag_point")[0];
  need(m <= MAX_DRAG_POINTS, `tensor modal.drag_point: expected at most ${MAX_DRAG_POINTS} rows`);
  const places = shapeOf(tensors, "modal.place")[0];
  need(places <= MAX_PLACES, `tensor modal.place: expected at most ${MAX_PLACES} rows`);
  checkShapes(tensors, {
    "modes.scale": [modes],
    "nodes.basis": [n, 3, modes],
    "nodes.rest_m": [n, 3],
    "nodes.turn": [n, 3, modes],
    "nodes.parent": [n],
    "joints.nodes": [j, 2],
    "joints.share": [j],
    "joints.rest_m": [j, 3],
    "render.vertex_joint": [vertices],
    "modal.step": [d, 6],
    "modal.load": [d, 2],
    "modal.sway": [2, d],
    "modal.force": [forceTerms(c), d],
    "modal.shown": [d],
    "modal.pose": [poseTerms(d, c), modes - d],
    "modal.limits": [3 + 2 * c],
    "modal.drag_point": [m, 2],
    "modal.drag_shape": [3, m, d],
    "modal.drag_rest": [d],
    "modal.drag_place": [m, places],
    "modal.place": [places, 3],
    "modal.place_load": [d, 2, places],
  });
}

function checkNumbers(table: Table): void {
  const { modeScale, modal } = table;
  need(
    modeScale.every((s) => s > 0),
    "tensor modes.scale: not positive",
  );
  checkJoints(table);
  need(
    modal.limits.every((limit) => limit > 0),
    "tensor modal.limits: not positive",
  );
  need(
    modal.dragRest.every((area) => area >= 0),
    "tensor modal.drag_rest: negative",
  );
  need(
    fitDrag(modal.dragPoint),
    "tensor modal.drag_point: expected areas of at least 0, not all 0, and shares in 0..1",
  );
  need(contracts(modal.step), "tensor modal.step: an oscillator is not stable");
}

function checkJoints({ nodeRest, nodeParent, jointNodes, jointShare, vertexJoint }: Table): void {
  const nodes = nodeRest.length / 3;
  need(
    nodeParent.every((parent, node) => parent <= node),
    "tensor nodes.parent: a node that does not come later",
  );
  need(
    jointNodes.every((node) => node < nodes),
    "tensor joints.nodes: node out of range",
  );
  need(
    jointShare.every((share) => share >= 0 && share <= 1),
    "tensor joints.share: expected shares in 0..1",
  );
  need(
    vertexJoint.every((joint) => joint < jointShare.length),
    "tensor render.vertex_joint: joint out of range",
  );
}

function fitDrag(point: Float32Array): boolean {
  let exposed = 0;
  for (let j = 0; j < point.length; j += 2) {
    if (!(point[j] >= 0 && point[j + 1] >= 0 && point[j + 1] <= 1)) return false;
    exposed += point[j];
  }
  return point.length === 0 || exposed > 0;
}
