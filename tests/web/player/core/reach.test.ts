/** The sway envelope of `galewood envelope` is the reach of the trees that the page plays. */
import { expect, test } from "vitest";
import { NodePose } from "../../../../web/player/src/core/motion/nodePose";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import type { WindDocument } from "../../../../web/player/src/core/wind/document";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { tableMotion } from "../../../../web/player/src/worker/table/tableMotion";
import { golden, goldenJson } from "../../golden";

interface Reach {
  wind: WindDocument;
  trees: number[][];
  frame_s: number;
  first_frame: number;
  last_frame: number;
  every: number;
  rest_m: number[][];
  height_m: number[];
  direction_deg: number[];
  reach_at_rest_m: number[][];
  reach_m: number[][][];
}

const TABLE = decodeTable(golden("pole.safetensors"));
const GOLDEN = goldenJson<Reach>("reach.json");
const STRIDE = Math.ceil((TABLE.metadata.modes + 1) / 4) * 4;
const NEAREST_M = 1e-4;

/** Largest distances from the trunk's axis by band of height and direction. */
class Reached {
  private readonly band = GOLDEN.rest_m.map(([, y]) =>
    Math.min(Math.max(GOLDEN.height_m.findIndex((edge) => edge >= y) - 1, 0), GOLDEN.height_m.length - 2),
  );
  readonly largest_m = GOLDEN.reach_at_rest_m.map((row) => [...row]);

  take(pose: NodePose): void {
    const out = new Float64Array(3);
    GOLDEN.rest_m.forEach(([x, y, z], vertex) => {
      pose.place(vertex, x, y, z, out);
      const row = this.largest_m[this.band[vertex]];
      GOLDEN.direction_deg.forEach((degrees, k) => {
        const angle = (degrees * Math.PI) / 180;
        row[k] = Math.max(row[k], out[0] * Math.cos(angle) + out[2] * Math.sin(angle));
      });
    });
  }
}

/** Reach of one tree, seen from its place: gusts within a crown fade with the distance of the viewer. */
function reachOf(tree: number[]): number[][] {
  const group = { key: "pole", table: TABLE, records: TABLE.paper, placement: Float32Array.from(tree), ids: [0], sha256: "", compliance: null };
  const motion = new LocalMotion([group], new WindField(GOLDEN.wind), { method: "modal", poseEasing: null }, 0);
  const out = [new Float32Array(STRIDE)];
  const pose = new NodePose(tableMotion("", TABLE, 0));
  const reached = new Reached();
  for (let frame = 1; frame <= GOLDEN.last_frame; frame++) {
    motion.see([tree[0], tree[1]]);
    motion.advance(GOLDEN.frame_s, out);
    if (frame >= GOLDEN.first_frame && frame % GOLDEN.every === 0) reached.take(pose.take(out[0]));
  }
  return reached.largest_m;
}

test("trees of the page reach as far in gusts as those of Python", () => {
  let farthest = 0;
  let worst = 0;
  GOLDEN.trees.map(reachOf).forEach((largest_m, tree) => {
    largest_m.forEach((row, band) => {
      row.forEach((own, k) => {
        farthest = Math.max(farthest, own - GOLDEN.reach_at_rest_m[band][k]);
        worst = Math.max(worst, Math.abs(own - GOLDEN.reach_m[tree][band][k]));
      });
    });
  });
  expect(farthest).toBeGreaterThan(0.5);
  expect(worst).toBeLessThan(NEAREST_M);
});
