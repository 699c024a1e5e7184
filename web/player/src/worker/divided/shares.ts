/** The trees of a plan, divided among workers so that each has as much to do as the others, wherever the viewer is. Pure. */
import { hashText } from "../../core/math/random";
import type { ForestPlan, GroupPlan, TreeAt } from "../protocol";

/** From this number of trees on a forest is divided, with a worker more for as many. */
export const TREES_PER_WORKER = 20_000;
/** Processor cores from which on there are two workers, and for how many more there is another one. */
const DIVIDED_FROM_CORES = 4;
const CORES_PER_WORKER = 2;
export const MOST_WORKERS = 4;
/** A smaller group stays in one worker: each group costs some time in every step, however many trees it has. */
export const DIVIDED_GROUP_TREES = 512;

/** A worker may be this late (s) before it holds up the others. Longer pauses, for example of a hidden tab, are skipped. */
export const MOST_LATE_S = 0.25;

/** Where the trees of a worker's group are in the whole plan: index of the group, and of each tree in it. */
export interface PartOfGroup extends Pick<GroupPlan, "rows"> {
  readonly group: number;
}

/** What one worker has of a plan. */
export interface Share {
  readonly groups: readonly GroupPlan[];
  readonly parts: readonly PartOfGroup[];
}

/** Workers for as many trees on a computer with these processor cores. */
export function workersFor(trees: number, cores: number): number {
  if (cores < DIVIDED_FROM_CORES) return 1;
  const most = Math.min(MOST_WORKERS, Math.floor(cores / CORES_PER_WORKER));
  return Math.min(most, 1 + Math.floor(trees / TREES_PER_WORKER));
}

/** Whether every tree of a plan moves by itself: not with a server's stream or clock, nor with records, which only one worker has. */
export const isDivisible = ({
  lookup,
  method,
  share,
}: Pick<ForestPlan, "lookup" | "method" | "share">): boolean =>
  lookup === "worker" && method === "modal" && share === null;

/** The share of each of `count` workers. A tree is in the same worker in every plan that has as many. */
export function sharesOf(groups: readonly GroupPlan[], count: number): Share[] {
  return Array.from({ length: count }, (_, worker) => {
    const own = groups.flatMap((group, g) => {
      const part = { group: g, rows: rowsOf(group, worker, count) };
      return part.rows?.length === 0 ? [] : [{ group: partOf(group, part.rows), part }];
    });
    return { groups: own.map(({ group }) => group), parts: own.map(({ part }) => part) };
  });
}

/** The trees of a group that a worker has; null: all. Ids count places row by row, so each worker has its trees everywhere. */
function rowsOf({ key, ids }: GroupPlan, worker: number, count: number): GroupPlan["rows"] {
  if (count === 1) return null;
  if (ids.length < DIVIDED_GROUP_TREES) return hashText(key) % count === worker ? null : new Uint32Array(0);
  const rows: number[] = [];
  for (let tree = 0; tree < ids.length; tree++) if (ids[tree] % count === worker) rows.push(tree);
  return Uint32Array.from(rows);
}

function partOf(group: GroupPlan, rows: GroupPlan["rows"]): GroupPlan {
  if (!rows) return group;
  const placement = new Float32Array(4 * rows.length);
  for (let k = 0; k < rows.length; k++)
    for (let c = 0; c < 4; c++) placement[4 * k + c] = group.placement[4 * rows[k] + c];
  return { ...group, rows, placement, ids: Uint32Array.from(rows, (row) => group.ids[row]) };
}

/** Where a tree of the whole plan is in a share; null if another worker has it. */
export function treeIn({ parts }: Share, { group, tree }: TreeAt): TreeAt | null {
  const own = parts.findIndex((part) => part.group === group);
  if (own < 0) return null;
  const { rows } = parts[own];
  const row = rows ? rows.indexOf(tree) : tree;
  return row < 0 ? null : { group: own, tree: row };
}

/** Where a tree of a share is in the whole plan. */
export function treeOf({ parts }: Share, { group, tree }: TreeAt): TreeAt {
  const part = parts[group];
  return { group: part.group, tree: part.rows ? part.rows[tree] : tree };
}
