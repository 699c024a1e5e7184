/** Sizes of an impostor's two pictures. Pure. */
import { VIEWS_PER_SIDE } from "./octahedral";

/** Size of one view's picture, px. */
export interface ViewSize {
  readonly width: number;
  readonly height: number;
}

/** Pixels of one view, more of them upwards, as trees are tall: colour and opacity, and (coarser) normal, depth and kind. */
export const COLOUR_VIEW: ViewSize = { width: 128, height: 256 };
export const SURFACE_VIEW: ViewSize = { width: 64, height: 128 };
/** Atlases kept at a time, which limits the memory: further species keep their geometry at every distance. */
export const MOST_ATLASES = 12;

/** Mip levels add a third. */
const MIP_FACTOR = 4 / 3;
/** Colour and opacity have four bits each (see `COLOUR_STEPS`). */
const COLOUR_BYTES_PER_PIXEL = 2;
const SURFACE_BYTES_PER_PIXEL = 4;
const CANVAS_BYTES_PER_PIXEL = 3 * 4;

/** Steps between none and all of a colour. Which of two is taken is left to chance, so that means over several texels are right. */
export const COLOUR_STEPS = 15;

const pixels = ({ width, height }: ViewSize): number => width * height;

/** GPU memory of one atlas, bytes. */
export const ATLAS_BYTES = Math.ceil(
  VIEWS_PER_SIDE ** 2 *
    MIP_FACTOR *
    (COLOUR_BYTES_PER_PIXEL * pixels(COLOUR_VIEW) + SURFACE_BYTES_PER_PIXEL * pixels(SURFACE_VIEW)),
);
/** Memory of the target into which one view is drawn before it is reduced: two pictures, one depth buffer. */
export const canvasBytes = (side: number): number => CANVAS_BYTES_PER_PIXEL * side * side;

/** Lower left pixel of one view in a picture. */
export function viewCorner(view: number, { width, height }: ViewSize): { left: number; bottom: number } {
  return { left: (view % VIEWS_PER_SIDE) * width, bottom: Math.floor(view / VIEWS_PER_SIDE) * height };
}

/**
 * Views to bake in this frame: few if frames are short, so that none is late. Where frames take long anyway, a view is a
 * small part of each.
 */
export function viewsPerFrame(frame_ms: number): number {
  if (frame_ms < 22) return 4;
  if (frame_ms < 60) return 2;
  if (frame_ms < 200) return 3;
  return frame_ms < 1000 ? 8 : 24;
}
