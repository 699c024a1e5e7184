/**
 * Leaves that are drawn one by one close to the eye, in place of cards and sprays: each spray is an instance of one of a few shapes. The
 * scene supplies the shapes and draws them; here is where the sprays stand, and which of them are close. Pure.
 */
import type { DrawnMotion } from "../../core/table/drawnTable";
import { LEVEL_COUNT, MOST_SHARE } from "../detail";
import type { DrawList, View } from "../drawList";
import { copyTree, INSTANCE_FLOATS } from "../instanceData";
import { WHOLE_SHARE } from "../jointAttribute";
import { MOST_LEAN } from "../lean";
import { type SingleLeaves, SPRAY_FLOATS } from "../mesh/singleLeaves";
import type { LevelTexels } from "../nodes/treeNodes";
import { ownRay } from "../treePick";
import type { Point } from "./culling";

/** Draws the close leaves of one species. */
export interface CloseLeaves {
  /** Takes the trees of a draw list in this view. */
  show(list: DrawList, instances: Float32Array, texels: readonly LevelTexels[], view: View): void;
  /** Triangles of the last selection. */
  readonly triangles: number;
  dispose(): void;
}

/** The joint and its vertex, the pivot and 0. */
const JOINT_FLOATS = 8;
/** Floats of an instance: the tree, the joint, the spray. */
export const CLOSE_FLOATS = INSTANCE_FLOATS + JOINT_FLOATS + SPRAY_FLOATS;

/** Sprays as they are held by the joints of a table. */
export interface HeldSprays extends Pick<SingleLeaves, "shapeOf" | "sprays" | "hold"> {
  readonly motion: Pick<DrawnMotion, "vertexJoint" | "jointNodes" | "jointShare" | "jointRest_m" | "levels">;
  /** Size of the tree, m. */
  readonly height_m: number;
  readonly radius_m: number;
  readonly leans: boolean;
}

/** Instances of one shape. */
export interface SprayRoom {
  data: Float32Array;
  count: number;
}

/** A ball about the eye in the frame of a tree: at least as large as that in the scene, which a lean shears. */
interface Ball {
  readonly x: number;
  readonly y: number;
  readonly z: number;
  readonly radius_m: number;
}

const UP_DIRECTION: Point = { x: 0, y: 1, z: 0 };

/** null: the tree is farther away. */
function ballIn(
  data: Float32Array,
  tree: number,
  { height_m, radius_m, leans }: HeldSprays,
  eye: Point,
  close_m: number,
): Ball | null {
  const at = tree * INSTANCE_FLOATS;
  const scale = data[at + 6];
  const reach_m = scale * (radius_m + (leans ? MOST_LEAN * height_m : 0)) + close_m;
  const away_m = Math.hypot(eye.x - data[at], eye.z - data[at + 2]);
  if (away_m > reach_m || eye.y - data[at + 1] > scale * height_m + close_m) return null;
  const [x, y, z] = ownRay({ data, leans }, tree, { from: eye, to: UP_DIRECTION });
  return { x, y, z, radius_m: (close_m * (1 + 2 * MOST_LEAN)) / scale };
}

/** Doubles the room of a shape when it is full. */
function place(room: SprayRoom): number {
  const at = room.count * CLOSE_FLOATS;
  if (at + CLOSE_FLOATS > room.data.length) {
    const larger = new Float32Array(2 * Math.max(room.data.length, CLOSE_FLOATS));
    larger.set(room.data);
    room.data = larger;
  }
  room.count++;
  return at;
}

/** Writes how a vertex is held at a level: as `jointAttribute`, then as `pivotAttribute`. */
function writeJoint(
  into: Float32Array,
  at: number,
  { vertexJoint, jointNodes, jointShare, jointRest_m }: HeldSprays["motion"],
  of: Uint16Array,
  vertex: number,
): void {
  const joint = vertexJoint[vertex];
  into[at] = of[jointNodes[2 * joint]];
  into[at + 1] = of[jointNodes[2 * joint + 1]];
  into[at + 2] = into[at] === into[at + 1] ? 0 : Math.round(WHOLE_SHARE * jointShare[joint]);
  into[at + 3] = vertex;
  for (let axis = 0; axis < 3; axis++) into[at + 4 + axis] = jointRest_m[3 * joint + axis];
}

/** Whether the point at this place of an array is in the ball. */
const within = ({ x, y, z, radius_m }: Ball, points: Float32Array, at: number): boolean =>
  (points[at] - x) ** 2 + (points[at + 1] - y) ** 2 + (points[at + 2] - z) ** 2 <= radius_m * radius_m;

/** Fills the rooms, one per shape, with the sprays of visible trees whose foot is closer to the eye than `close_m`. */
export function fillClose(
  rooms: readonly SprayRoom[],
  held: HeldSprays,
  list: DrawList,
  instances: Float32Array,
  texels: readonly LevelTexels[],
  eye: Point,
  close_m: number,
): void {
  const { sprays, shapeOf, hold, motion } = held;
  for (const room of rooms) room.count = 0;
  for (let level = 0; level < LEVEL_COUNT; level++) {
    const { first, trees, nodes } = texels[level];
    const { of } = motion.levels[level];
    for (let k = 0; k < Math.min(trees, list.visible[level]); k++) {
      const tree = list.order[list.start[level] + k];
      const ball = ballIn(instances, tree, held, eye, close_m);
      if (!ball) continue;
      for (let spray = 0; spray < shapeOf.length; spray++) {
        if (!within(ball, sprays, spray * SPRAY_FLOATS)) continue;
        const room = rooms[shapeOf[spray]];
        const at = place(room);
        copyTree(instances, tree, room.data, at, first + k * nodes, MOST_SHARE);
        writeJoint(room.data, at + INSTANCE_FLOATS, motion, of, hold[spray]);
        for (let i = 0; i < SPRAY_FLOATS; i++) {
          room.data[at + INSTANCE_FLOATS + JOINT_FLOATS + i] = sprays[spray * SPRAY_FLOATS + i];
        }
      }
    }
  }
}
