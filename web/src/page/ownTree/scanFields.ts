/** What can be corrected only in a scanned tree. Its parts are known. */
import type { Assumptions } from "../server/api";
import { IMPORT_LIMITS } from "../server/schema";
import type { Scan } from "./assumed";
import { numberField, row, select } from "./formRows";

export function scanFields(
  { dbh_cm, min_radius_mm, dropped, bare }: Scan,
  change: (assumptions: Assumptions) => void,
): HTMLElement[] {
  const diameter = numberField(dbh_cm, { ...IMPORT_LIMITS.dbh_cm, step: 0.1 }, (value) =>
    change({ dbh_cm: value }),
  );
  diameter.disabled = dbh_cm === null;
  const least = numberField(min_radius_mm, { ...IMPORT_LIMITS.min_radius_mm, step: 0.5 }, (value) =>
    change({ min_radius_mm: value }),
  );
  const choices = [
    ["added", "Added"],
    ["none", "None"],
  ] as const;
  const leaves = select(choices, bare ? "none" : "added", (value) =>
    change({ add_leaves: value === "added" }),
  );
  const low = "the trunk does not reach 1.3 m";
  return [
    row("Trunk (cm)", diameter, dbh_cm === null ? low : "diameter at 1.3 m; all radii are scaled with it"),
    row("Finest (mm)", least, `${dropped} dropped: branches nowhere as thick as this radius`),
    row("Leaves", leaves, "a scan has none; their area is assumed"),
  ];
}
