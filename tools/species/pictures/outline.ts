/** A point of a leaf: x across, y from the petiole (0) to the tip (1), in leaf lengths. */
export type LeafPoint = readonly [number, number];

/** Right half of a leaf's outline, from the petiole to the tip. */
export type Outline = readonly LeafPoint[];

/** Crossings of many rows with the outline of the blade, for a fast point test. */
type OutlineRows = readonly (readonly number[])[];

const ROW_COUNT = 1024;
const LOWEST_HEIGHT_SHARE = -0.2;
const ROW_HEIGHT = 1.4 / ROW_COUNT;
const rowsOf = new WeakMap<Outline, OutlineRows>();

function outlineRows(outline: Outline): OutlineRows {
  const known = rowsOf.get(outline);
  if (known) return known;
  const rows = Array.from({ length: ROW_COUNT }, (_, k) =>
    crossings(outline, LOWEST_HEIGHT_SHARE + (k + 0.5) * ROW_HEIGHT),
  );
  rowsOf.set(outline, rows);
  return rows;
}

/** Crossings of the closed right half (outline and midrib) with a row. */
function crossings(outline: Outline, y: number): number[] {
  const found: number[] = [];
  outline.forEach(([ax, ay], i) => {
    const [bx, by] = outline[(i + 1) % outline.length];
    if (ay > y !== by > y) found.push(ax + ((bx - ax) * (y - ay)) / (by - ay));
  });
  return found;
}

/** Even-odd point test; `x` is the distance from the midrib. */
export function insideLeaf(outline: Outline, x: number, y: number): boolean {
  const row = outlineRows(outline)[Math.floor((y - LOWEST_HEIGHT_SHARE) / ROW_HEIGHT)] ?? [];
  let within = false;
  for (const edge of row) if (x < edge) within = !within;
  return within;
}
