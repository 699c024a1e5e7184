/** Version 6 tables, which always held records and kept their metadata beside the rest. */

import type { Json } from "./container";
import { poses, type Records } from "./records";

const PAPER_NAMES = [
  "records",
  "points",
  "components",
  "sampled_elements",
  "sigma_pa",
  "weight",
  "pose_easing",
];
const REACH_MARGIN = 1.25;

const listAt = (of: unknown, name: string): unknown[] => {
  const found = (of as Json | null | undefined)?.[name];
  return Array.isArray(found) ? found : [];
};

/** Metadata of a version 6 table, with those of the records in `paper`. `trajectories`: their number. */
export function fromVersion6(metadata: Json, version: number, trajectories: number): Json {
  const all = Object.entries(metadata);
  const paper = Object.fromEntries(all.filter(([name]) => PAPER_NAMES.includes(name)));
  const kept = Object.fromEntries(all.filter(([name]) => !PAPER_NAMES.includes(name)));
  const winds = listAt(metadata.provenance, "winds").slice(0, trajectories);
  const frames = listAt(metadata.provenance, "frames").slice(0, trajectories);
  return { ...kept, version, paper: { ...paper, winds, frames } };
}

/** Largest pressure of all records, Pa. */
export function peakPressure_pa({ pressure }: Records): number {
  let peak = 0;
  for (let i = 0; i + 1 < pressure.length; i += 2) {
    peak = Math.max(peak, Math.hypot(pressure[i], pressure[i + 1]));
  }
  return peak;
}

/** Largest displacement of any node over the poses of all records, with a margin, m. `nodeBasis`: [n, 3, r]. */
export function reach_m(records: Records, nodeBasis: Float32Array, modeScale: Float32Array): number {
  const r = modeScale.length;
  const q = Float64Array.from(poses(records), (value, i) => value * modeScale[i % r]);
  let most = 0;
  for (let node = 0; node < nodeBasis.length; node += 3 * r) {
    for (let pose = 0; pose < q.length; pose += r) {
      let square = 0;
      for (let axis = node; axis < node + 3 * r; axis += r) {
        let moved = 0;
        for (let k = 0; k < r; k++) moved += nodeBasis[axis + k] * q[pose + k];
        square += moved * moved;
      }
      if (square > most) most = square;
    }
  }
  return Math.max(REACH_MARGIN * Math.sqrt(most), 1e-6);
}
