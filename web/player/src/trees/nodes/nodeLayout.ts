/** How pass 1's target is laid out: flat texels, wrapped at a power of two, each level on rows of its own. Pure. */

export interface NodeLayout {
  readonly width: number;
  /** log2 of the width. */
  readonly shift: number;
  readonly height: number;
}

/** The smallest layout for `texels` texels in `parts` runs, each starting on a new row. */
export function nodeLayout(texels: number, parts: number, maxSide: number): NodeLayout {
  const largestShift = Math.floor(Math.log2(maxSide));
  const rows = (log2: number) => Math.max(1, Math.ceil(texels / 2 ** log2) + parts);
  let shift = Math.min(8, largestShift);
  while (shift < largestShift && rows(shift) > 2 ** shift) shift++;
  return { width: 2 ** shift, shift, height: Math.min(maxSide, rows(shift)) };
}

/** The rows of one level in the target, and its number of trees. */
export interface LevelRows {
  readonly row: number;
  readonly rows: number;
  readonly trees: number;
}

/** The rows of each level; the farthest trees are omitted if there is no space. */
export function levelRows(
  layout: NodeLayout,
  nodes: readonly number[],
  trees: ArrayLike<number>,
): LevelRows[] {
  let row = 0;
  return nodes.map((size, level) => {
    const room = Math.floor(((layout.height - row) * layout.width) / size);
    const fitting = Math.min(trees[level], Math.max(0, room));
    const rows = Math.ceil((fitting * size) / layout.width);
    const place = { row, rows, trees: fitting };
    row += rows;
    return place;
  });
}
