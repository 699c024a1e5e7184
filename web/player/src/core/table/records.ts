/**
 * The records of the paper's state search: part of a table, or a separate file that follows later. Everything is
 * validated here, so that they can be searched without bounds checks.
 */

import { MAX_MODES, RECORD_TENSORS, RECORDS_FORMAT, RECORDS_VERSION } from "../constants";
import {
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

interface RecordsMetadata {
  readonly records: number;
  readonly points: number;
  readonly components: number;
  readonly sampled_elements?: number;
  readonly sigma_pa: number;
  readonly weight: { readonly initial: number; readonly maximum: number; readonly growth: number };
  readonly pose_easing: number;
  readonly [more: string]: unknown;
}

/** z records of r modes with their candidate lists. Units in spec/formats/table.md. */
export interface Records {
  readonly metadata: RecordsMetadata;
  /** [z, r] in units of the table's modeScale */
  readonly dq: Int16Array;
  /** [z, 2] Pa */
  readonly pressure: Float32Array;
  /** start of each trajectory, and z */
  readonly trajectory: Uint32Array;
  /** [z + 1] candidates of each state, CSR */
  readonly offsets: Uint32Array;
  readonly candidate: Uint16Array;
  readonly mismatches: Uint16Array;
}

/** A decoded records file. */
export interface RecordsFile {
  readonly records: Records;
  /** Hash of the table file that they belong to. */
  readonly tableSha256: string;
  readonly modes: number;
}

/** Decodes a records file. Throws TableError that names the fault. */
export function decodeRecords(file: ArrayBuffer | Uint8Array): RecordsFile {
  const container = readContainer(file);
  checkFormat(container.metadata, RECORDS_FORMAT, RECORDS_VERSION);
  const { table_sha256, paper } = container.metadata;
  need(typeof table_sha256 === "string", "metadata table_sha256: expected a string");
  refuseUnknown(container.header, RECORD_TENSORS);
  const tensors = readTensors(container, RECORD_TENSORS);
  checkFilled(container);
  checkFinite(tensors);
  const modes = whole(container.metadata, "modes", MAX_MODES);
  return { records: readRecords(paper, tensors, modes), tableSha256: table_sha256, modes };
}

/** The records of a file that was made for the table with this hash and number of modes. Throws TableError. */
export function recordsOf(
  file: ArrayBuffer | Uint8Array,
  table: { readonly sha256: string; readonly modes: number },
): Records {
  const { records, tableSha256, modes } = decodeRecords(file);
  need(tableSha256 === table.sha256, "these records belong to another table");
  need(modes === table.modes, `tensor samples.dq: ${modes} modes, expected ${table.modes}`);
  return records;
}

/** The records from their metadata and stored tensors, whose numbers are finite. Throws TableError. */
export function readRecords(metadata: unknown, tensors: Tensors, modes: number): Records {
  const checked = checkMetadata(object(metadata, "metadata paper: expected an object"));
  const z = checked.records;
  checkShapes(tensors, {
    "samples.dq": [z, modes],
    "samples.pressure_pa": [z, 2],
    "search.offsets": [z + 1],
    "search.mismatch_steps": shapeOf(tensors, "search.record"),
  });
  const records: Records = {
    metadata: checked,
    dq: valuesOf(tensors, "samples.dq"),
    pressure: valuesOf(tensors, "samples.pressure_pa"),
    trajectory: valuesOf(tensors, "samples.trajectory"),
    offsets: valuesOf(tensors, "search.offsets"),
    candidate: valuesOf(tensors, "search.record"),
    mismatches: valuesOf(tensors, "search.mismatch_steps"),
  };
  checkTrajectories(records);
  checkOffsets(records);
  sumSteps(records);
  checkSearch(records);
  return records;
}

/** [z, r] pose of every record, in units of modeScale; every trajectory starts at 0. */
export function poses({ dq, trajectory, metadata }: Records): Int32Array {
  const r = dq.length / metadata.records;
  const out = new Int32Array(dq.length);
  for (let t = 0; t + 1 < trajectory.length; t++) {
    for (let i = trajectory[t] + 1; i < trajectory[t + 1]; i++) {
      for (let k = 0; k < r; k++) out[i * r + k] = out[(i - 1) * r + k] + dq[(i - 1) * r + k];
    }
  }
  return out;
}

/** [z] 1 for the last record of each trajectory, which has no successor and is never chosen. */
export function lastRecords(trajectory: Uint32Array): Uint8Array {
  const last = new Uint8Array(trajectory[trajectory.length - 1]);
  for (let t = 1; t < trajectory.length; t++) last[trajectory[t] - 1] = 1;
  return last;
}

function checkMetadata(metadata: Json): RecordsMetadata {
  number(metadata, "sigma_pa", 1e-9, 1e9);
  number(metadata, "pose_easing", 0, 1);
  for (const name of ["records", "points", "components"]) whole(metadata, name, 65535);
  const weight = object(metadata.weight, "metadata weight: expected an object");
  number(weight, "maximum", number(weight, "initial", 0, 0.999), 0.999);
  number(weight, "growth", 0, 1);
  return metadata as unknown as RecordsMetadata;
}

function checkTrajectories({ trajectory, metadata: { records } }: Records): void {
  const ends = trajectory.length >= 2 && trajectory[0] === 0 && trajectory.at(-1) === records;
  need(ends, "tensor samples.trajectory: must run from 0 to the number of records");
  for (let t = 1; t < trajectory.length; t++) {
    // A trajectory of one record could never be chosen: its only record has no successor.
    need(
      trajectory[t] - trajectory[t - 1] >= 2 && trajectory[t] <= records,
      "tensor samples.trajectory: every trajectory needs two records",
    );
  }
}

function checkOffsets({ offsets, candidate, metadata: { records: z } }: Records): void {
  need(
    offsets[0] === 0 && offsets[z] === candidate.length,
    "tensor search.offsets: must run from 0 to the end",
  );
  for (let c = 0; c < z; c++) {
    need(offsets[c + 1] > offsets[c], "tensor search.offsets: every record needs a candidate");
    need(offsets[c + 1] <= candidate.length, "tensor search.offsets: must run from 0 to the end");
  }
}

/** Decodes the mismatches, which are delta-coded along each row of candidates. */
function sumSteps({ offsets, mismatches }: Records): void {
  for (let c = 0; c + 1 < offsets.length; c++) {
    for (let s = offsets[c] + 1; s < offsets[c + 1]; s++) {
      const sum = mismatches[s - 1] + mismatches[s];
      need(sum <= 65535, "tensor search.mismatch_steps: out of range");
      mismatches[s] = sum;
    }
  }
}

function checkSearch({ offsets, candidate, mismatches, trajectory, metadata }: Records): void {
  const z = metadata.records;
  const last = lastRecords(trajectory);
  for (let c = 0; c < z; c++) {
    let before = -1;
    for (let s = offsets[c]; s < offsets[c + 1]; s++) {
      const key = mismatches[s] * 65536 + candidate[s];
      need(key > before, "tensor search.record: candidates out of order");
      need(
        candidate[s] < z && last[candidate[s]] === 0,
        "tensor search.record: out of range, or the last of its trajectory",
      );
      need(mismatches[s] <= metadata.components, "tensor search.mismatch_steps: out of range");
      before = key;
    }
  }
}
