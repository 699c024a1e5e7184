/** How the node target is laid out: flat texels, wrapped at a power of two. Pure. */

export interface NodeLayout {
  readonly width: number;
  readonly height: number;
  /** log2 of the width. */
  readonly shift: number;
  /** Trees that fit. */
  readonly capacity: number;
}

/** Rows of floats for one tree: modes and one more for the local wind speed, padded to whole texels. */
export function poseStride(modes: number): number {
  return Math.ceil((modes + 1) / 4) * 4;
}

/** The smallest power-of-two width (at least 256) whose height stays within the largest texture side. */
export function nodeLayout(nodes: number, trees: number, maxSide: number): NodeLayout {
  const texels = Math.max(1, nodes * trees);
  const largestShift = Math.floor(Math.log2(maxSide));
  let shift = Math.min(8, largestShift);
  while (shift < largestShift && texels > 2 ** (2 * shift)) shift++;
  const width = 2 ** shift;
  const height = Math.min(maxSide, Math.ceil(texels / width));
  return { width, height, shift, capacity: Math.floor((width * height) / nodes) };
}
