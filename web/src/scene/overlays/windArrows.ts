/** The wind at places in a tree, as arrows whose length and colour show its speed. */
import {
  Color,
  ConeGeometry,
  CylinderGeometry,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  Quaternion,
  Vector3,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

const METRES_PER_M_S = 0.16;
const LONGEST_M = 4;
const LULL_COLOUR = new Color(0x6fa8ff);
const MEAN_COLOUR = new Color(0xf4f1e6);
const GUST_COLOUR = new Color(0xff7a1a);
const ARROW_DIRECTION = new Vector3(0, 1, 0);

/** An arrow along y, 1 m long, from the origin. */
function arrow() {
  const shaft = new CylinderGeometry(0.012, 0.012, 0.75, 6).translate(0, 0.375, 0);
  const head = new ConeGeometry(0.05, 0.25, 8).translate(0, 0.875, 0);
  const both = mergeGeometries([shaft, head]);
  shaft.dispose();
  head.dispose();
  return both;
}

export class WindArrows {
  readonly mesh: InstancedMesh;
  private readonly matrix = new Matrix4();
  private readonly turn = new Quaternion();
  private readonly along = new Vector3();
  private readonly size = new Vector3();
  private readonly colour = new Color();

  constructor(count: number) {
    const material = new MeshBasicMaterial({
      depthTest: false,
      transparent: true,
      opacity: 0.9,
      toneMapped: false,
    });
    this.mesh = new InstancedMesh(arrow(), material, count);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 9;
  }

  /** Shows the wind (m/s) at a place in the world; `mean_m_s` is the speed of the middle colour. */
  set(index: number, place: Vector3, { x, z }: { x: number; z: number }, mean_m_s: number): void {
    const speed = Math.hypot(x, z);
    const length = Math.min(LONGEST_M, METRES_PER_M_S * speed);
    this.along.set(speed > 0 ? x / speed : 1, 0, speed > 0 ? z / speed : 0);
    this.turn.setFromUnitVectors(ARROW_DIRECTION, this.along);
    this.size.set(1 + 0.3 * length, Math.max(1e-3, length), 1 + 0.3 * length);
    this.mesh.setMatrixAt(index, this.matrix.compose(place, this.turn, this.size));
    const gust = Math.max(-1, Math.min(1, (speed - mean_m_s) / Math.max(0.5, 0.5 * mean_m_s)));
    this.mesh.setColorAt(
      index,
      this.colour.copy(MEAN_COLOUR).lerp(gust < 0 ? LULL_COLOUR : GUST_COLOUR, Math.abs(gust)),
    );
  }

  /** Call after all arrows are set. */
  update(): void {
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
    (this.mesh.material as MeshBasicMaterial).dispose();
    this.mesh.dispose();
  }
}
