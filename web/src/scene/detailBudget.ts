/** Keeps the triangles of the trees within a budget: where many trees are near, their full detail ends nearer to the eye. Pure. */

/** How near detail may come to the eye, relative to where it usually ends. */
const LEAST_REACH = 0.25;
/** The triangles that can be saved grow with the area, the square of the distance; the nearest trees keep theirs. */
const TRIANGLES_EXPONENT = 1.4;
/** Detail reaches farther again when this share of the budget is used; far from 1, so that it does not go to and fro. */
const AMPLE_SHARE = 0.8;
/** What a smaller reach aims at, in parts of the budget. */
const AIMED_SHARE = 0.93;
/** Largest changes at a time. */
const MOST_SHRINKING = 0.6;
const MOST_GROWTH = 1.15;

export class DetailBudget {
  /** Factor of the distances up to which trees show their details. */
  reach = 1;

  /** Takes the number of triangles that this reach gives. Returns whether the reach has changed. */
  take(triangles: number, most: number): boolean {
    const before = this.reach;
    const wanted = ((AIMED_SHARE * most) / Math.max(1, triangles)) ** (1 / TRIANGLES_EXPONENT);
    if (triangles > most) this.reach = Math.max(LEAST_REACH, before * Math.max(MOST_SHRINKING, wanted));
    else if (triangles < AMPLE_SHARE * most) this.reach = Math.min(1, before * Math.min(MOST_GROWTH, wanted));
    return this.reach !== before;
  }
}
