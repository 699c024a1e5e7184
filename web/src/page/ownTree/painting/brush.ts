/** The pieces under a round brush that is dragged over a picture of their rows. Pure. */

/** A picture in which every pixel is a row + 1, or 0 where nothing is drawn; its first line is the lowest. */
export interface RowPicture {
  readonly width: number;
  readonly height: number;
  /** Four bytes per pixel: the row in the first three, the smallest first. */
  readonly pixels: Uint8Array;
}

export interface Place {
  readonly x: number;
  readonly y: number;
}

/** The rows within `radius` pixels of the line between two places (from the upper left corner). */
export function rowsUnder(picture: RowPicture, from: Place, to: Place, radius: number): Set<number> {
  const { width, height, pixels } = picture;
  const found = new Set<number>();
  const [left, right] = [Math.min(from.x, to.x) - radius, Math.max(from.x, to.x) + radius];
  const [top, bottom] = [Math.min(from.y, to.y) - radius, Math.max(from.y, to.y) + radius];
  for (let y = Math.max(0, Math.ceil(top)); y <= Math.min(height - 1, bottom); y++) {
    for (let x = Math.max(0, Math.ceil(left)); x <= Math.min(width - 1, right); x++) {
      const at = 4 * ((height - 1 - y) * width + x);
      const row = pixels[at] + 256 * pixels[at + 1] + 65536 * pixels[at + 2] - 1;
      if (row >= 0 && !found.has(row) && distance(x, y, from, to) <= radius) found.add(row);
    }
  }
  return found;
}

/** Distance of a point from the line between two places. */
function distance(x: number, y: number, from: Place, to: Place): number {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const square = dx * dx + dy * dy;
  const along = square > 0 ? ((x - from.x) * dx + (y - from.y) * dy) / square : 0;
  const share = Math.min(1, Math.max(0, along));
  return Math.hypot(x - from.x - share * dx, y - from.y - share * dy);
}
