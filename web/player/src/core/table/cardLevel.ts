/** The nodes of the trunk by which an impostor bends: halfway up and at the top. Pure. */
import type { DrawnMotion, NodeLevel } from "./drawnTable";

/** Two nodes of a table by which a whole tree bends, and the height of the middle one relative to the tip. */
export interface BendNodes {
  readonly middle: number;
  readonly tip: number;
  readonly middleAt: number;
}

/** The nodes nearest to the axis halfway up and at the top. */
export function bendNodes({ rest_m, height_m }: Pick<DrawnMotion, "rest_m" | "height_m">): BendNodes {
  const nearest = (share: number) => {
    const away_m = new Float32Array(rest_m.length / 3).map((_, node) => {
      const [x, y, z] = rest_m.subarray(3 * node);
      return Math.abs(y - share * height_m) + Math.hypot(x, z);
    });
    return away_m.indexOf(Math.min(...away_m));
  };
  const [middle, tip] = [nearest(0.55), nearest(1)];
  const at = rest_m[3 * middle + 1] / Math.max(1e-3, rest_m[3 * tip + 1]);
  return { middle, tip, middleAt: Math.min(0.8, Math.max(0.2, at)) };
}

/** Nodes that a level has at its end for impostors: not merged with others, because such means move less than the tip, nor linked. */
export const BEND_NODE_COUNT = 2;

/** The nodes for impostors of a level alone: all that a tree needs of which nothing else is drawn. */
export function cardLevel({ nodes, quads, coordinates, of, basis, turn, rest_m }: NodeLevel): NodeLevel {
  const first = nodes - BEND_NODE_COUNT;
  return {
    nodes: BEND_NODE_COUNT,
    quads,
    coordinates,
    of: of.map(() => 0),
    basis: basis.slice(12 * quads * first),
    turn: turn.slice(12 * quads * first),
    rest_m: rest_m.slice(3 * first),
    parent: Uint16Array.of(0, 1),
    bend: [0, 1],
  };
}
