/** Time per frame of a worker's forest: wind, step and packing, seen from its middle. */
import { readFileSync } from "node:fs";
import { packetBytes, packPoses } from "../../player/src/core/motion/posePacket";
import { poseStride } from "../../player/src/core/motion/poseStride";
import { decodeTable } from "../../player/src/core/table/table";
import { WindField } from "../../player/src/core/wind/field";
import { PRESETS } from "../../player/src/core/wind/presets";
import { LocalMotion } from "../../player/src/worker/motion/localMotion";
import { FOREST_CENTRE, placeTrees } from "../../src/scene/placement";

export interface ForestTiming {
  readonly radius_m: number;
  readonly least_ms: number;
  readonly median_ms: number;
  /** What is sent to the page in the last frame. */
  readonly packet_bytes: number;
}

const USUAL_SPECIES = ["poplar", "oak", "beech", "birch", "spruce"];
const SHIPPED_FOLDER = new URL("../../../assets/species/shipped/", import.meta.url);
const FRAME_S = 1 / 60;
const WARM_UP_FRAMES = 150;
const MEASURED_FRAMES = 180;
/** Half the angle that the page has stepped in full: of a wide picture, and some more for turns. */
const HALF_ANGLE_RAD = 0.9;

/** Ten tables, whose trees stand among each other where the page plants them. */
function groupsOf(trees: number) {
  const names = USUAL_SPECIES.flatMap((species) => [species, `${species}-forest`]);
  const rows: number[][] = names.map(() => []);
  placeTrees(trees, 1).forEach(({ x_m, z_m, yaw_rad, scale }, k) => {
    rows[k % names.length].push(x_m, z_m, yaw_rad, scale);
  });
  return names.map((key, g) => ({
    key,
    table: decodeTable(readFileSync(new URL(`${key}.table`, SHIPPED_FOLDER))),
    records: null,
    ids: Uint32Array.from({ length: rows[g].length / 4 }, (_, id) => id),
    placement: Float32Array.from(rows[g]),
    sha256: key,
    compliance: null,
  }));
}

export function benchForest(preset: keyof typeof PRESETS, trees: number): ForestTiming {
  const groups = groupsOf(trees);
  const motion = new LocalMotion(
    groups,
    new WindField(PRESETS[preset]),
    { method: "modal", poseEasing: null },
    0,
  );
  const shapes = groups.map(({ ids, table }) => {
    const { modes } = table.metadata;
    const stride = poseStride(modes);
    return { modes, stride, poses: new Float32Array(ids.length * stride) };
  });
  const buffers = shapes.map(({ poses }) => poses);
  const packed = () => shapes.map((shape, g) => ({ ...shape, changed: motion.changed[g] ?? null }));
  motion.see([FOREST_CENTRE.x_m, FOREST_CENTRE.z_m, 0, -1, Math.cos(HALF_ANGLE_RAD)]);
  const taken_ms: number[] = [];
  let packet = packPoses(packed(), null);
  for (let frame = 0; frame < WARM_UP_FRAMES + MEASURED_FRAMES; frame++) {
    const begin_ms = performance.now();
    motion.advance(FRAME_S, buffers);
    packet = packPoses(packed(), packet);
    if (frame >= WARM_UP_FRAMES) taken_ms.push(performance.now() - begin_ms);
  }
  taken_ms.sort((a, b) => a - b);
  const last = placeTrees(trees, 1).at(-1);
  const radius_m = last ? Math.hypot(last.x_m - FOREST_CENTRE.x_m, last.z_m - FOREST_CENTRE.z_m) : 0;
  return {
    radius_m: Math.round(radius_m),
    least_ms: taken_ms[0],
    median_ms: taken_ms[MEASURED_FRAMES / 2],
    packet_bytes: packetBytes(packed()),
  };
}
