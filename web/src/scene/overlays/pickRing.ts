/** A ring on the ground around the picked tree. */
import { BufferAttribute, BufferGeometry, Mesh, MeshBasicMaterial } from "three";
import { groundHeight_m } from "../ground/landscape";

const CORNER_COUNT = 72;
const WIDTH_M = 0.16;
const ABOVE_M = 0.07;

export class PickRing {
  readonly mesh: Mesh<BufferGeometry, MeshBasicMaterial>;

  constructor() {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(CORNER_COUNT * 6), 3));
    geometry.setIndex(Array.from({ length: CORNER_COUNT }, (_, k) => this.quad(k)).flat());
    const material = new MeshBasicMaterial({
      color: 0xfff1c4,
      transparent: true,
      opacity: 0.85,
      depthWrite: false,
      toneMapped: false,
      polygonOffset: true,
      polygonOffsetFactor: -4,
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  private quad(k: number): number[] {
    const [a, b] = [2 * k, 2 * ((k + 1) % CORNER_COUNT)];
    return [a, a + 1, b, b, a + 1, b + 1];
  }

  /** Shows the ring around a position, draped over the ground. */
  show(x: number, z: number, radius_m: number): void {
    const position = this.mesh.geometry.getAttribute("position") as BufferAttribute;
    for (let k = 0; k < CORNER_COUNT; k++) {
      const angle = (2 * Math.PI * k) / CORNER_COUNT;
      [radius_m, radius_m + WIDTH_M].forEach((radius, side) => {
        const px = x + radius * Math.cos(angle);
        const pz = z - radius * Math.sin(angle);
        position.setXYZ(2 * k + side, px, groundHeight_m(px, pz) + ABOVE_M, pz);
      });
    }
    position.needsUpdate = true;
    this.mesh.visible = true;
  }

  hide(): void {
    this.mesh.visible = false;
  }
}
