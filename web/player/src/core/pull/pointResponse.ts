/**
 * Static response of a tree to a force at one vertex, in the tree's frame, at scale 1. The reasons
 * are in docs/design/0018-pulling.md.
 */
import { BINDING_CORNERS, PULL_FORCE_SHARE, PULL_MOST_REACH, WHOLE_WEIGHT } from "../constants";
import { jointRow } from "../table/jointRow";
import type { Table } from "../table/table";
import type { Compliance } from "./compliance";
import { displacementOfRow, displacementOfRows, unitResponses } from "./factor";

/** d oscillators, r modes; columns are the forces along x, y, z, per N. */
export interface PointResponse {
  readonly node: number;
  /** [3, r] displacement of the vertex per unit of q */
  readonly point: Float64Array;
  /** [d, 3] coordinates of the oscillators, m·√kg */
  readonly oscillators: Float64Array;
  /** [r, 3] m of q */
  readonly pose: Float64Array;
  /** [3, 3] m: of the whole tree, or of its modes alone */
  readonly compliance: Float64Array;
  readonly limit_N: number;
  readonly reach_m: number;
  /** Displacement that the modes do not show; null without a compliance file. */
  readonly rest: RestResponse | null;
}

/** The part of the response that the modes do not show. */
export interface RestResponse {
  /** [v, 3, 3] m at each vertex: displacement x, y, z per force along x, then along y, then along z */
  readonly field: Float32Array<ArrayBuffer>;
  /** [3, 3] N/m: twice its strain energy, and [3, 3] kg: its inertia, both per N²; symmetric */
  readonly yields: Float64Array;
  readonly inertia: Float64Array;
}

export class PullError extends Error {
  override readonly name = "PullError";
}

/** Whether a compliance file belongs to the mesh of a table. */
const fits = (compliance: Compliance, { metadata, vertexNode }: Table): boolean =>
  compliance.meshSha256 === metadata.mesh_sha256 && compliance.vertexRow.length === vertexNode.length;

/** Throws PullError if the tree has no such vertex. A compliance file of another mesh is ignored. */
export function pointResponse(table: Table, vertex: number, file: Compliance | null): PointResponse {
  const count = table.vertexNode.length;
  if (!(Number.isInteger(vertex) && vertex >= 0 && vertex < count))
    throw new PullError(`the mesh has ${count} vertices: there is no vertex ${vertex}`);
  const { modes: r, height_m } = table.metadata;
  const node = table.vertexNode[vertex];
  const point = jointRow(table, table.vertexJoint[vertex], new Float64Array(3 * r));
  const oscillators = oscillatorsOf(table, point);
  const pose = poseOf(table, oscillators);
  const own = { node, point, oscillators, pose, reach_m: PULL_MOST_REACH * height_m };
  if (!file || !fits(file, table))
    return { ...own, compliance: symmetric(times(point, pose, r)), limit_N: Infinity, rest: null };
  const units = unitResponses(file, vertex);
  const compliance = symmetric(atRow(file, units, file.vertexRow[vertex]));
  const rest = restOf(table, file, units, own, compliance);
  return { ...own, compliance, limit_N: limitOf(file, vertex), rest };
}

/** [d] s²: coordinate of each oscillator at rest per unit of a constant force, 1/ω². */
function staticGain({ modal: { step } }: Table): Float64Array {
  return Float64Array.from({ length: step.length / 6 }, (_, k) => {
    const [a, b, c, d, s0, s1] = step.subarray(6 * k, 6 * k + 6);
    return (b * s1 - d * s0) / (a * d - b * c);
  });
}

function oscillatorsOf(table: Table, point: Float64Array): Float64Array {
  const gain = staticGain(table);
  const { shown } = table.modal;
  const r = table.metadata.modes;
  const out = new Float64Array(3 * gain.length);
  for (let k = 0; k < gain.length; k++)
    for (let axis = 0; axis < 3; axis++) out[3 * k + axis] = gain[k] * point[axis * r + k] * shown[k];
  return out;
}

/** [r, 3]: the modes' coordinates that follow the oscillators [d, 3] linearly. */
function poseOf(table: Table, oscillators: Float64Array): Float64Array {
  const { shown, pose } = table.modal;
  const r = table.metadata.modes;
  const d = shown.length;
  const out = new Float64Array(3 * r);
  for (let axis = 0; axis < 3; axis++) {
    for (let k = 0; k < d; k++) out[3 * k + axis] = shown[k] * oscillators[3 * k + axis];
    for (let k = d; k < r; k++) {
      let sum = 0;
      for (let i = 0; i < d; i++) sum += pose[i * (r - d) + k - d] * oscillators[3 * i + axis];
      out[3 * k + axis] = sum;
    }
  }
  return out;
}

/** [3, 3] = rows [3, r] × columns [r, 3]. */
function times(rows: ArrayLike<number>, columns: Float64Array, r: number): Float64Array {
  const out = new Float64Array(9);
  for (let i = 0; i < 3; i++)
    for (let j = 0; j < 3; j++) {
      let sum = 0;
      for (let k = 0; k < r; k++) sum += rows[i * r + k] * columns[3 * k + j];
      out[3 * i + j] = sum;
    }
  return out;
}

const symmetric = (m: Float64Array): Float64Array =>
  m.map((_, at) => 0.5 * (m[at] + m[3 * (at % 3) + Math.floor(at / 3)]));

/** [3, 3]: displacement of a row of the binding, a column per unit force. */
function atRow(file: Compliance, units: readonly Float64Array[], row: number): Float64Array {
  return Float64Array.from({ length: 9 }, (_, at) =>
    displacementOfRow(file, units[at % 3], row, Math.floor(at / 3)),
  );
}

/** The permitted share of the mean of the breaking forces of the nodes that carry the vertex. */
function limitOf(file: Compliance, vertex: number): number {
  const row = file.vertexRow[vertex] * BINDING_CORNERS;
  let sum = 0;
  let weights = 0;
  for (let k = row; k < row + BINDING_CORNERS; k++) {
    if (file.node[k] >= file.free) continue;
    sum += (file.weight[k] / WHOLE_WEIGHT) * file.limit_N[file.node[k]];
    weights += file.weight[k] / WHOLE_WEIGHT;
  }
  return (PULL_FORCE_SHARE * sum) / Math.max(weights, 1e-9);
}

/** [v, 3, 3]: what the modes do not show, a column per force direction. */
function restField(
  { nodeBasis, nodeRest, jointNodes, jointShare, vertexJoint, metadata: { modes: r } }: Table,
  file: Compliance,
  units: readonly Float64Array[],
  pose: Float64Array,
): Float32Array<ArrayBuffer> {
  const shown = new Float64Array(3 * nodeRest.length);
  for (let axis = 0; axis < nodeRest.length; axis++) {
    const [node, i] = [Math.floor(axis / 3), axis % 3];
    for (let j = 0; j < 3; j++) {
      let sum = 0;
      for (let k = 0; k < r; k++) sum += nodeBasis[axis * r + k] * pose[3 * k + j];
      shown[9 * node + 3 * j + i] = sum;
    }
  }
  const whole = displacementOfRows(file, units);
  const field = new Float32Array(9 * vertexJoint.length);
  for (let vertex = 0, at = 0; vertex < vertexJoint.length; vertex++) {
    const row = 9 * file.vertexRow[vertex];
    const joint = vertexJoint[vertex];
    const share = jointShare[joint];
    const [first, second] = [9 * jointNodes[2 * joint], 9 * jointNodes[2 * joint + 1]];
    for (let k = 0; k < 9; k++, at++)
      field[at] = whole[row + k] - (1 - share) * shown[first + k] - share * shown[second + k];
  }
  return field;
}

function restOf(
  table: Table,
  file: Compliance,
  units: readonly Float64Array[],
  { point, oscillators, pose }: Pick<PointResponse, "point" | "oscillators" | "pose">,
  compliance: Float64Array,
): RestResponse {
  const r = table.metadata.modes;
  const d = table.modal.shown.length;
  const field = restField(table, file, units, pose);
  const yields = new Float64Array(9);
  const inertia = new Float64Array(9);
  for (let i = 0; i < 3; i++)
    for (let j = 0; j < 3; j++) {
      let held = compliance[3 * i + j];
      let mass = 0;
      for (let k = 0; k < d; k++) {
        held -= point[i * r + k] * table.modal.shown[k] * oscillators[3 * k + j];
        mass -= oscillators[3 * k + i] * oscillators[3 * k + j];
      }
      for (let n = 0; n < file.free; n++)
        for (let axis = 0; axis < 3; axis++)
          mass += file.mass_kg[n] * units[i][3 * n + axis] * units[j][3 * n + axis];
      yields[3 * i + j] = held;
      inertia[3 * i + j] = mass;
    }
  return { field, yields, inertia };
}
