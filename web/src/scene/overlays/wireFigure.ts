/** Lines between moving points, drawn over everything else. */
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

export interface WireStyle {
  /** Of all lines, or rgb of each of them. */
  readonly colour: number | Float32Array;
  readonly width_px: number;
  readonly opacity: number;
}

/** The colours of lines, repeated for both ends. */
function ofBothEnds(colour: Float32Array): Float32Array {
  return Float32Array.from({ length: 2 * colour.length }, (_, i) => colour[3 * Math.floor(i / 6) + (i % 3)]);
}

export class WireFigure {
  readonly lines: LineSegments2;
  private readonly ends: Float32Array;

  /** `pairs` holds the two point indices of every line. */
  constructor(
    private readonly pairs: Uint32Array,
    { colour, width_px, opacity }: WireStyle,
  ) {
    this.ends = new Float32Array(3 * pairs.length);
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(this.ends);
    const own = typeof colour !== "number";
    if (own) geometry.setColors(ofBothEnds(colour));
    const material = new LineMaterial({
      color: own ? 0xffffff : colour,
      vertexColors: own,
      linewidth: width_px,
      transparent: true,
      opacity,
      depthTest: false,
      depthWrite: false,
      toneMapped: false,
    });
    this.lines = new LineSegments2(geometry, material);
    this.lines.frustumCulled = false; // it moves beyond the bounds of its rest shape
    this.lines.renderOrder = 9;
  }

  /** Moves the points: `rest` and `moved` hold xyz of each. */
  move(rest: Float32Array, moved: Float32Array): void {
    const start = this.lines.geometry.getAttribute("instanceStart") as unknown as {
      data: { array: Float32Array; needsUpdate: boolean };
    };
    const to = start.data.array;
    for (let end = 0; end < this.pairs.length; end++) {
      const from = 3 * this.pairs[end];
      for (let axis = 0; axis < 3; axis++) to[3 * end + axis] = rest[from + axis] + moved[from + axis];
    }
    start.data.needsUpdate = true;
  }

  dispose(): void {
    this.lines.removeFromParent();
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}
