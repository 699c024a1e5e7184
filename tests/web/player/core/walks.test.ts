import { createHash } from "node:crypto";
import { describe, expect, test } from "vitest";
import { PaperForest } from "../../../../web/player/src/core/motion/paperSearch";
import type { Records } from "../../../../web/player/src/core/table/records";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { ModalForest } from "../../../../web/player/src/core/modal/modalForest";
import { parseWind, type WindDocument } from "../../../../web/player/src/core/wind/document";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { golden, goldenJson } from "../../golden";

interface Walks {
  frames: number;
  every: number;
  steps_per_pa: number;
  trees: { x_m: number[]; z_m: number[]; yaw_rad: number[]; scale: number[] };
  walks: { wind: WindDocument; records: string[]; poses: number[][] }[];
}

const TABLE = decodeTable(golden("pole.safetensors"));
const { frames, every, steps_per_pa, trees, walks } = goldenJson<Walks>("walks.json");
const count = trees.x_m.length;

/** State of the forests after every hundred frames: records found so far, and poses. */
function* walk(wind: WindDocument): Generator<[string, Float32Array]> {
  const field = new WindField(parseWind(wind));
  const paper = new PaperForest(TABLE, TABLE.paper as Records, count);
  const modal = new ModalForest(TABLE, count);
  for (const forest of [paper, modal]) forest.setTrees(trees.x_m, trees.z_m, trees.yaw_rad, trees.scale);
  const px = new Float64Array(count);
  const pz = new Float64Array(count);
  const records = createHash("sha256");
  for (let frame = 0; frame < frames; frame++) {
    field.pressure(trees.x_m, trees.z_m, field.at(frame / 30), px, pz, TABLE.metadata.streamlined_exponent);
    // Rounded as in Python, so that the last bit of a velocity does not change a record.
    for (const p of [px, pz]) p.forEach((pa, i) => p.fill(Math.floor(pa * steps_per_pa + 0.5) / steps_per_pa, i, i + 1));
    paper.advance(1 / 30, px, pz);
    modal.advance(1 / 30, px, pz);
    records.update(new Uint8Array(paper.record.buffer));
    if (frame % every === every - 1) yield [records.copy().digest("hex").slice(0, 16), modal.q];
  }
}

describe("agrees with Python over 10,000 frames: all records, and poses to 1e-5 of the height", () => {
  for (const golden of walks) {
    test(golden.wind.model, { timeout: 60_000 }, () => {
      let row = 0;
      for (const [records, poses] of walk(golden.wind)) {
        expect(records, `records up to frame ${(row + 1) * every}`).toBe(golden.records[row]);
        const worst = golden.poses[row].reduce((most, q, k) => Math.max(most, Math.abs(q - poses[k])), 0);
        expect(worst / TABLE.metadata.height_m, `poses of frame ${(row + 1) * every}`).toBeLessThan(1e-5);
        row++;
      }
      expect(row).toBe(golden.records.length);
    });
  }
});
