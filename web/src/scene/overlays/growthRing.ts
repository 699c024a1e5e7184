/** A soft ring on the ground around a tree whose motion is being computed; its bright part grows with the progress. */
import { BufferAttribute, BufferGeometry, Mesh, MeshBasicMaterial } from "three";
import { groundHeight_m } from "../ground/landscape";

const CORNER_COUNT = 96;
const WIDTH_M = 0.5;
const ABOVE_M = 0.08;
/** Distances across the ring, 0 inside to 1 outside, and their opacity: soft edges. */
const RING_PROFILE = [
  [0, 0],
  [0.5, 1],
  [1, 0],
] as const;
const RING_OPACITY = { done: 0.8, open: 0.25 } as const;

export class GrowthRing {
  readonly mesh: Mesh<BufferGeometry, MeshBasicMaterial>;

  constructor() {
    const geometry = new BufferGeometry();
    const vertices = (CORNER_COUNT + 1) * RING_PROFILE.length;
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(vertices * 3), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(vertices * 4), 4));
    geometry.setIndex(Array.from({ length: CORNER_COUNT }, (_, k) => quads(k)).flat());
    const material = new MeshBasicMaterial({
      vertexColors: true,
      transparent: true,
      depthWrite: false,
      toneMapped: false,
      polygonOffset: true,
      polygonOffsetFactor: -4,
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
  }

  /** Shows the ring around a position; `fraction`: progress, 0 to 1. */
  show(x: number, z: number, radius_m: number, fraction: number): void {
    const position = this.mesh.geometry.getAttribute("position") as BufferAttribute;
    const colour = this.mesh.geometry.getAttribute("color") as BufferAttribute;
    for (let k = 0; k <= CORNER_COUNT; k++) {
      const angle = (2 * Math.PI * k) / CORNER_COUNT;
      const opacity = k <= fraction * CORNER_COUNT ? RING_OPACITY.done : RING_OPACITY.open;
      RING_PROFILE.forEach(([across, soft], side) => {
        const radius = radius_m + across * WIDTH_M;
        const px = x + radius * Math.sin(angle);
        const pz = z - radius * Math.cos(angle);
        const at = RING_PROFILE.length * k + side;
        position.setXYZ(at, px, groundHeight_m(px, pz) + ABOVE_M, pz);
        colour.setXYZW(at, 1, 0.83, 0.5, soft * opacity);
      });
    }
    position.needsUpdate = true;
    colour.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

/** The triangles between two corners of the ring, which face upwards. */
function quads(k: number): number[] {
  const [a, b] = [RING_PROFILE.length * k, RING_PROFILE.length * (k + 1)];
  return [0, 1].flatMap((i) => [a + i, b + i, a + i + 1, b + i, b + i + 1, a + i + 1]);
}
