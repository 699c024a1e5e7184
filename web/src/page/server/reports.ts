/** The reports of trees: fetched when they are first shown, and again once their tree has changed. */

import { fetchTree, type ReportedTree, type Tree } from "./api";

type Report = ReportedTree["report"] | null;

interface Fetched {
  /** Of the tree when it was fetched. */
  readonly updated_at: string;
  readonly report: Promise<Report>;
}

const fetched = new Map<string, Fetched>();

/** The report of a tree; null if it cannot be fetched, which is tried again the next time. */
export function reportOf({ id, updated_at }: Pick<Tree, "id" | "updated_at">): Promise<Report> {
  const known = fetched.get(id);
  if (known?.updated_at === updated_at) return known.report;
  const report = fetchTree(id).then(
    (tree) => tree.report,
    () => {
      if (fetched.get(id)?.report === report) fetched.delete(id);
      return null;
    },
  );
  fetched.set(id, { updated_at, report });
  return report;
}
