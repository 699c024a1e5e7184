/** The nodes of trees that are drawn as cards only: those by which a card bends, and those below them. Pure. */
import type { DrawnMotion, NodeLevel } from "./drawnTable";

/** Two nodes of the trunk by which a whole tree bends. */
export interface BendNodes {
  readonly middle: number;
  readonly tip: number;
  /** Height of the middle one relative to the tip. */
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

/**
 * The nodes of a level by which a card bends, and all nodes between them and the ground, so that links are shortened as in
 * the whole level, and a tree that becomes a card moves on as it did. The first of them stands for the table's other nodes.
 */
export function cardLevel(
  { of, basis, turn, rest_m, parent, ...same }: NodeLevel,
  { middle, tip }: BendNodes,
): NodeLevel {
  const chain = (node: number): number[] => (parent[node] === node ? [node] : [...chain(parent[node]), node]);
  const kept = [...new Set([...chain(of[middle]), ...chain(of[tip])])];
  const place = (node: number) => Math.max(0, kept.indexOf(node));
  const pick = (rows: Float32Array, size: number) =>
    Float32Array.from(kept.flatMap((node) => [...rows.subarray(node * size, (node + 1) * size)]));
  return {
    ...same,
    nodes: kept.length,
    of: of.map(place),
    basis: pick(basis, 12 * same.quads),
    turn: pick(turn, 12 * same.quads),
    rest_m: pick(rest_m, 3),
    parent: Uint16Array.from(kept, (node) => place(parent[node])),
  };
}
