/**
 * The compliance file: how a tree yields to forces at its points. Specified in spec/formats/compliance.md.
 * Everything is validated, so that it can be solved without bounds checks.
 */
import {
  BINDING_CORNERS,
  COMPLIANCE_FORMAT,
  COMPLIANCE_TENSORS,
  COMPLIANCE_VERSION,
  MAX_COMPLIANCE_NODES,
  WHOLE_WEIGHT,
} from "../constants";
import {
  checkFilled,
  checkFinite,
  checkFormat,
  checkShapes,
  need,
  readContainer,
  readTensors,
  refuseUnknown,
  shapeOf,
  valuesOf,
  whole,
} from "../table/container";

/**
 * Cholesky factor of the tangent stiffness in 3 × 3 blocks: n free nodes in elimination order, b blocks, w rows of
 * weights, v render vertices. The diagonal block of a column comes first and holds the inverse of its factor.
 */
export interface Compliance {
  readonly meshSha256: string;
  readonly free: number;
  /** [n + 1] */
  readonly pointer: Uint32Array;
  /** [b] */
  readonly rows: Uint16Array;
  /** [b, 9] */
  readonly blocks: Float32Array;
  /** [n] */
  readonly mass_kg: Float32Array;
  /** [n] force at which the wood would break, N */
  readonly limit_N: Float32Array;
  /** [w, 4], n for a clamped node */
  readonly node: Uint16Array;
  /** [w, 4] in units of 1 / WHOLE_WEIGHT */
  readonly weight: Uint16Array;
  /** [v] */
  readonly vertexRow: Uint32Array;
}

/** Decodes a compliance file. Throws TableError that names the fault. */
export function decodeCompliance(file: ArrayBuffer | Uint8Array): Compliance {
  const container = readContainer(file);
  checkFormat(container.metadata, COMPLIANCE_FORMAT, COMPLIANCE_VERSION);
  const { mesh_sha256 } = container.metadata;
  const tensors = readTensors(container, COMPLIANCE_TENSORS);
  refuseUnknown(container.header, COMPLIANCE_TENSORS);
  checkFilled(container);
  const free = whole(container.metadata, "nodes", MAX_COMPLIANCE_NODES);
  const [blocks] = shapeOf(tensors, "factor.rows");
  const [rows] = shapeOf(tensors, "bind.node");
  checkShapes(tensors, {
    "factor.pointer": [free + 1],
    "factor.blocks": [blocks, 9],
    "nodes.mass_kg": [free],
    "nodes.limit_n": [free],
    "bind.node": [rows, BINDING_CORNERS],
    "bind.weight": [rows, BINDING_CORNERS],
  });
  checkFinite(tensors);
  const values = (name: string) => valuesOf(tensors, name);
  const compliance: Compliance = {
    meshSha256: String(mesh_sha256),
    free,
    pointer: values("factor.pointer"),
    rows: values("factor.rows"),
    blocks: values("factor.blocks"),
    mass_kg: values("nodes.mass_kg"),
    limit_N: values("nodes.limit_n"),
    node: values("bind.node"),
    weight: values("bind.weight"),
    vertexRow: values("bind.vertex_row"),
  };
  checkFactor(compliance);
  checkBinding(compliance);
  return compliance;
}

function checkFactor({ free, pointer, rows, blocks, mass_kg, limit_N }: Compliance): void {
  need(
    pointer[0] === 0 && pointer[free] === rows.length,
    "tensor factor.pointer: must rise from 0 to the number of blocks",
  );
  for (let k = 0; k < free; k++) {
    const first = pointer[k];
    need(first < pointer[k + 1], "tensor factor.pointer: must rise from 0 to the number of blocks");
    need(rows[first] === k, "tensor factor.rows: not a lower triangle, diagonal first");
    for (let q = first + 1; q < pointer[k + 1]; q++)
      need(rows[q] > k && rows[q] < free, "tensor factor.rows: not a lower triangle, diagonal first");
    const positive = blocks[9 * first] > 0 && blocks[9 * first + 2] > 0 && blocks[9 * first + 5] > 0;
    need(positive, "tensor factor.blocks: the diagonal must be positive");
    need(mass_kg[k] > 0, "tensor nodes.mass_kg: must be positive");
    need(limit_N[k] > 0, "tensor nodes.limit_n: must be positive");
  }
}

function checkBinding({ free, node, weight, vertexRow }: Compliance): void {
  const rows = node.length / BINDING_CORNERS;
  for (let row = 0; row < rows; row++) {
    let sum = 0;
    for (let k = row * BINDING_CORNERS; k < (row + 1) * BINDING_CORNERS; k++) {
      need(node[k] <= free, "tensor bind.node: out of range");
      sum += weight[k];
    }
    need(sum === WHOLE_WEIGHT, "tensor bind.weight: a row does not sum to 65535");
  }
  for (const row of vertexRow) need(row < rows, "tensor bind.vertex_row: out of range");
}
