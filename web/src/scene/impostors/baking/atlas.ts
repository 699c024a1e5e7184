/** The pictures of one tree from all sides: what an impostor is drawn from. */

import type { TreeModel } from "galewood/trees";
import {
  ClampToEdgeWrapping,
  LinearFilter,
  LinearMipmapLinearFilter,
  NoColorSpace,
  type TextureDataType,
  UnsignedByteType,
  UnsignedShort4444Type,
  WebGLRenderTarget,
} from "three";
import { COLOUR_VIEW, SURFACE_VIEW, type ViewSize } from "./atlasLayout";
import { VIEWS_PER_SIDE } from "./octahedral";
import { type TreeBox, treeBox } from "./treeBox";

export const VIEW_COUNT = VIEWS_PER_SIDE * VIEWS_PER_SIDE;

function picture({ width, height }: ViewSize, type: TextureDataType): WebGLRenderTarget {
  const target = new WebGLRenderTarget(VIEWS_PER_SIDE * width, VIEWS_PER_SIDE * height, {
    depthBuffer: false,
    magFilter: LinearFilter,
    minFilter: LinearMipmapLinearFilter,
    wrapS: ClampToEdgeWrapping,
    wrapT: ClampToEdgeWrapping,
    colorSpace: NoColorSpace,
    type,
    generateMipmaps: false, // only after the last view
  });
  target.scissorTest = true;
  return target;
}

export class Atlas {
  readonly box: TreeBox;
  /** Colour without light, multiplied by the opacity; opacity. Sixteen bits look the same as 32. */
  readonly colour = picture(COLOUR_VIEW, UnsignedShort4444Type);
  /** Normal (octahedron), depth, kind and openness to the sky. */
  readonly surface = picture(SURFACE_VIEW, UnsignedByteType);
  /** Views that have been drawn since the last start. */
  done = 0;
  /** Whether all views have been drawn once, so that trees can be shown. */
  complete = false;
  /** Whether the pictures show the tree without its leaves. */
  leafless = false;

  constructor(readonly model: TreeModel) {
    this.box = treeBox(model.parts.map(({ position }) => position.array));
  }

  /** Draws all views again; until then the old ones are shown. */
  restart(leafless: boolean): void {
    this.leafless = leafless && !this.model.evergreen;
    this.done = 0;
  }

  get isBaked(): boolean {
    return this.done >= VIEW_COUNT;
  }

  dispose(): void {
    this.colour.dispose();
    this.surface.dispose();
  }
}
