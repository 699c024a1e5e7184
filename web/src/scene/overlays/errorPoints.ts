/** A dot at every node of a tree, from white (no error) to red (the largest). */
import { BufferAttribute, BufferGeometry, Color, Points, PointsMaterial } from "three";

const EXACT_COLOUR = new Color(0xf4f1e6);
const ERROR_COLOUR = new Color(0xff2a12);

export class ErrorPoints {
  readonly points: Points<BufferGeometry, PointsMaterial>;

  /** `share`: error of each node relative to the largest. */
  constructor(share: Float32Array) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * share.length), 3));
    const colours = new Float32Array(3 * share.length);
    const colour = new Color();
    share.forEach((part, node) => {
      colour.lerpColors(EXACT_COLOUR, ERROR_COLOUR, Math.sqrt(part)).toArray(colours, 3 * node);
    });
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    const material = new PointsMaterial({
      size: 7,
      sizeAttenuation: false,
      vertexColors: true,
      depthTest: false,
      transparent: true,
      toneMapped: false,
    });
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 9;
  }

  /** Moves the dots: `rest` and `moved` hold xyz of each node. */
  move(rest: Float32Array, moved: Float32Array): void {
    const position = this.points.geometry.getAttribute("position") as BufferAttribute;
    const to = position.array as Float32Array;
    for (let i = 0; i < to.length; i++) to[i] = rest[i] + moved[i];
    position.needsUpdate = true;
  }

  dispose(): void {
    this.points.removeFromParent();
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}
