/** Distant trees, stepped less: how far they are from where the full model has them, in pixels, and what they cost. */
import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { advance, treesOf } from "../../../../web/player/src/core/forest/trees";
import { JointWind } from "../../../../web/player/src/core/motion/jointWind";
import { EasedPoses } from "../../../../web/player/src/core/motion/easedPoses";
import { type PackedGroup, packetBytes, packPoses } from "../../../../web/player/src/core/motion/posePacket";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { FAR_COORDINATES, leadingCoordinates } from "../../../../web/player/src/core/table/leadingCoordinates";
import { decodeTable, type Table } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { FAR_LEVELS } from "../../../../web/player/src/core/motion/simulationLevels";
import { type LocalGroup, LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { seededRandom } from "../../seeded";

const NAMES = ["poplar", "maple-forest", "apricot"];
const TABLES = NAMES.map((name) => decodeTable(readFileSync(`assets/species/shipped/${name}.table`)));
const FRAME_S = 1 / 60;

const easedOf = ({ metadata, modal }: Table, count: number) =>
  new EasedPoses(count, metadata.modes, leadingCoordinates(metadata.modes, modal.step.length / 6, FAR_COORDINATES));

/** Pixels per radian of a picture 720 pixels high with the page's angle of view of 46°. */
const PX_PER_RAD = 360 / Math.tan((23 * Math.PI) / 180);
const SPACE_M2 = 36.9;

/** `count` trees of each table at these distances from the middle, by default in a disc as dense as the page's forest. */
function forest(
  count: number,
  next: () => number,
  awayAt = (share: number) => Math.sqrt((share * TABLES.length * count * SPACE_M2) / Math.PI),
): LocalGroup[] {
  return TABLES.map((table, g) => {
    const places = Array.from({ length: count }, () => {
      const [away_m, angle] = [awayAt(next()), 2 * Math.PI * next()];
      return [away_m * Math.cos(angle), away_m * Math.sin(angle), 2 * Math.PI * next(), 0.78 + 0.5 * next() ** 1.4];
    });
    const ids = Uint32Array.from({ length: count }, (_, id) => id);
    return { key: NAMES[g], table, records: null, ids, placement: Float32Array.from(places.flat()), sha256: "", compliance: null };
  });
}

/** A worker's motion and the page's poses of it. */
class Shown {
  readonly poses: EasedPoses[];
  bytes = 0;
  private readonly buffers: Float32Array[];

  constructor(
    readonly motion: LocalMotion,
    private readonly groups: readonly LocalGroup[],
  ) {
    this.poses = groups.map(({ ids, table }) => easedOf(table, ids.length));
    this.buffers = this.poses.map(({ poses }) => poses.slice());
  }

  advance(dt_s = FRAME_S): void {
    this.motion.advance(dt_s, this.buffers);
    const packed = this.groups.map(({ table }, g): PackedGroup => {
      const { modes } = table.metadata;
      return { poses: this.buffers[g], stride: poseStride(modes), modes, changed: this.motion.changed[g] ?? null };
    });
    this.bytes = packetBytes(packed);
    const packet = packPoses(packed, null);
    const at = { row: 0, near: 0, far: 0 };
    for (const [g, poses] of this.poses.entries()) {
      poses.begin();
      poses.take(packet, g, at);
    }
  }
}

function topmost({ nodeRest }: Table): number {
  let top = 0;
  for (let node = 0; node < nodeRest.length / 3; node++) if (nodeRest[3 * node + 1] > nodeRest[3 * top + 1]) top = node;
  return top;
}

/** Displacement of a node along an axis, m at scale 1, as the page shows it. */
function displaced(table: Table, node: number, axis: number, shown: EasedPoses, tree: number): number {
  const { modes } = table.metadata;
  const share = shown.share(tree);
  const { coordinates, before, poses } = shown;
  const basis = (k: number) => table.nodeBasis[(3 * node + axis) * modes + k];
  let sum = 0;
  for (let k = 0; k < modes; k++) sum += basis(k) * poses[tree * poseStride(modes) + k];
  if (share === 1) return sum;
  for (const [at, k] of coordinates.entries()) {
    const past = before[tree * coordinates.length + at];
    sum -= (1 - share) * basis(k) * (poses[tree * poseStride(modes) + k] - past);
  }
  return sum;
}

/** Half the angle of view of such a picture across, rad, and what is added to it for turns, as the page does. */
const HALF_RAD = Math.atan((16 / 9) * Math.tan((23 * Math.PI) / 180));
const TURN_RAD = 0.25;

describe("distant trees at 1280 × 720 from eye height, a camera that moves at 5 m/s", () => {
  test.each([
    ["breeze", 61, null, 140],
    ["storm-front", 62, null, 140],
    ["breeze", 64, 0.5, 100],
    ["storm-front", 65, 0.5, 100],
  ] as const)("%s (seed %i, turning by %s rad/s): within 0.5 px RMS of the full model, without jumps above 1 px", (preset, seed, turning_rad_s, nearest_m) => {
    const next = seededRandom(seed);
    const fromM = [nearest_m, ...FAR_LEVELS.slice(1).map(({ from_m }) => from_m)];
    const groups = forest(350, next, (share) => 100 + 1000 * share);
    const field = new WindField(PRESETS[preset]);
    const levels = new Shown(new LocalMotion(groups, field, { method: "modal", poseEasing: null }, 0), groups);
    const full = groups.map(({ table, placement }) => treesOf(table, placement));
    const wind = new JointWind(full.map((trees) => trees.wind));
    const exact = groups.map(({ table, ids }) => easedOf(table, ids.length));
    const tops = TABLES.map(topmost);
    const errors = new Map<string, number>();
    const squares = fromM.map(() => 0);
    const numbers = fromM.map(() => 0);
    let most = 0;
    let jump = 0;
    for (let frame = 0; frame < 900; frame++) {
      const x = -40 + 5 * FRAME_S * frame;
      const heading_rad = FRAME_S * frame * (turning_rad_s ?? 0);
      const ahead = [Math.cos(heading_rad), Math.sin(heading_rad)] as const;
      levels.motion.see(turning_rad_s === null ? [x, 0] : [x, 0, ...ahead, Math.cos(HALF_RAD + TURN_RAD)]);
      levels.advance();
      for (const trees of full) trees.see([x, 0]);
      advance(full, wind, field, frame * FRAME_S, FRAME_S);
      for (const [g, trees] of full.entries()) trees.write(exact[g].poses);
      if (frame < 120) continue;
      for (const [g, { placement, table }] of groups.entries()) {
        for (let tree = 0; tree < placement.length / 4; tree++) {
          const [dx, dz] = [placement[4 * tree] - x, placement[4 * tree + 1]];
          const away_m = Math.hypot(dx, dz);
          const ring = fromM.findLastIndex((from_m) => away_m >= from_m);
          if (ring < 0) continue;
          if (turning_rad_s !== null && dx * ahead[0] + dz * ahead[1] < Math.cos(HALF_RAD) * away_m) {
            for (let axis = 0; axis < 3; axis++) errors.delete(`${g} ${tree} ${axis}`);
            continue;
          }
          for (let axis = 0; axis < 3; axis++) {
            const off_m = displaced(table, tops[g], axis, levels.poses[g], tree) - displaced(table, tops[g], axis, exact[g], tree);
            const off_px = (PX_PER_RAD * placement[4 * tree + 3] * off_m) / away_m;
            squares[ring] += off_px * off_px;
            numbers[ring]++;
            most = Math.max(most, Math.abs(off_px));
            const key = `${g} ${tree} ${axis}`;
            jump = Math.max(jump, Math.abs(off_px - (errors.get(key) ?? off_px)));
            errors.set(key, off_px);
          }
        }
      }
    }
    const rms = squares.map((sum, ring) => Math.sqrt(sum / numbers[ring]));
    const stated = rms.map((px, ring) => `${px.toFixed(3)} px from ${fromM[ring]} m`).join(", ");
    console.log(`${preset}: RMS ${stated}; at most ${most.toFixed(2)} px; change per frame at most ${jump.toFixed(3)} px`);
    for (const px of rms) expect(px).toBeLessThan(0.5);
    expect(jump).toBeLessThan(1);
  });
});

test("100,000 trees: less than 1.5 MB per frame, and every frame steps about as many", () => {
  const next = seededRandom(43);
  const groups = forest(33_333, next);
  const shown = new Shown(new LocalMotion(groups, new WindField(PRESETS.breeze), { method: "modal", poseEasing: null }, 0), groups);
  const [times, stepped] = [[] as number[], [] as number[]];
  for (let frame = 0; frame < 90; frame++) {
    shown.motion.see([0, 0]);
    const begin_ms = performance.now();
    shown.advance();
    if (frame < 30) continue;
    times.push(performance.now() - begin_ms);
    expect(shown.bytes).toBeLessThan(1.5e6);
    stepped.push(shown.motion.changed.reduce((sum, c) => sum + (c ? c.near.length + c.far.reduce((all, { length }) => all + length, 0) : 0), 0));
  }
  times.sort((a, b) => a - b);
  console.log(`${times[0].toFixed(1)} to ${times[30].toFixed(1)} ms, ${(shown.bytes / 1e6).toFixed(2)} MB per frame`);
  expect(Math.max(...stepped) / Math.min(...stepped)).toBeLessThan(1.05);
});
