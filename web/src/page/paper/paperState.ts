/** What is known about the paper's method for one tree, and its words. Pure. */

import { RECORDS_STAGE, STAGES_AFTER_TABLE } from "../../constants";
import { isActive, type Job } from "../server/api";
import type { KnownTree } from "../server/catalogue";
import { displayName, tableWords } from "../ui/words";

export type PaperState =
  | { readonly kind: "ready" | "loading" | "later" | "missing" | "bare" }
  | { readonly kind: "computing"; readonly fraction: number };

const AFTER_TABLE: readonly string[] = STAGES_AFTER_TABLE;
const MOST_LINES = 4;

/** Whether the table is complete and only the paper's records or the bare table are still being computed. */
export const onlyExtrasLeft = (job: Job | null): job is Job =>
  isActive(job) && AFTER_TABLE.includes(job.stage);

/** Whether the server has the records of the table that moves this tree. */
export function isRecorded({ tree, motion }: KnownTree): boolean {
  if (!motion) return false;
  return motion.hasRecords || recordsFileOf({ tree, motion }) !== null;
}

/** The records file that belongs to the table of this tree; null if there is none, or the table holds them. */
export function recordsFileOf({
  tree,
  motion,
}: Pick<KnownTree, "tree" | "motion">): { readonly table: string; readonly records: string } | null {
  const records = tree.records_sha256 ?? null;
  if (!motion || motion.hasRecords || !records || tree.table_sha256 !== motion.sha256) return null;
  return { table: motion.sha256, records };
}

/** `loading`: whether this browser is fetching the records. */
export function paperStateOf(known: KnownTree, loading: boolean): PaperState {
  if (loading) return { kind: "loading" };
  if (known.motion?.foliage === "bare") return { kind: "bare" };
  if (isRecorded(known)) return { kind: "ready" };
  const { job } = known;
  if (isActive(job) && job.stage === RECORDS_STAGE)
    return { kind: "computing", fraction: Math.min(1, Math.max(0, job.fraction)) };
  return { kind: isActive(job) && !onlyExtrasLeft(job) ? "later" : "missing" };
}

export function paperWords(state: PaperState): string {
  if (state.kind === "computing") return `being computed, ${Math.round(100 * state.fraction)} %`;
  return {
    ready: "ready",
    loading: "loading",
    later: "follows the full table",
    missing: "not computed",
    bare: "only in leaf",
  }[state.kind];
}

/** How complete the table of a tree is, and what about the paper's method. */
export function stateWords({ tree, motion, job }: KnownTree, state: PaperState): string {
  const table = tableWords(motion, job, Boolean(tree.table_sha256));
  return motion && state.kind !== "later" ? `${table} Paper's method: ${paperWords(state)}.` : table;
}

/** Which trees cannot use the paper's method yet, one a line; empty if all can. */
export function paperNote(trees: readonly { known: KnownTree; state: PaperState }[]): string {
  const open = trees.filter(({ state }) => state.kind !== "ready");
  if (open.length === 0) return "";
  const lines = open
    .slice(0, MOST_LINES)
    .map(({ known, state }) => `${displayName(known.tree)}: ${paperWords(state)}`);
  if (open.length > MOST_LINES) lines.push(`and ${open.length - MOST_LINES} more`);
  const waits = open.some(({ state }) => state.kind !== "missing" && state.kind !== "bare");
  return [...lines, waits ? "Using the modal model until then." : "Using the modal model instead."].join(
    "\n",
  );
}
