/** The point at which a tree is pulled, and a line to where the hand is. Drawn over the trees. */
import { CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";

/** Sizes relative to the distance from the eye. */
const KNOB_SIZE_RATIO = 0.0065;
const HAND_SIZE_RATIO = 0.0045;
const LINE_WIDTH_RATIO = 0.0014;
const HANDLE_COLOUR = 0xffd27a;
const RIM_COLOUR = 0x1b1408;
const UP_DIRECTION = new Vector3(0, 1, 0);

const material = (color: number, opacity: number) =>
  new MeshBasicMaterial({ color, opacity, transparent: true, depthTest: false, toneMapped: false });

export class PullHandle {
  readonly group = new Group();
  private readonly ball = new SphereGeometry(1, 20, 14);
  private readonly stick = new CylinderGeometry(1, 1, 1, 8);
  private readonly rim = new Mesh(this.ball, material(RIM_COLOUR, 0.55));
  private readonly knob = new Mesh(this.ball, material(HANDLE_COLOUR, 1));
  private readonly shade = new Mesh(this.stick, material(RIM_COLOUR, 0.45));
  private readonly line = new Mesh(this.stick, material(HANDLE_COLOUR, 0.95));
  private readonly hand = new Mesh(this.ball, material(HANDLE_COLOUR, 0.9));
  private readonly along = new Vector3();

  constructor() {
    this.group.add(this.shade, this.rim, this.line, this.hand, this.knob);
    this.group.visible = false;
    for (const [k, mesh] of this.meshes.entries()) {
      mesh.renderOrder = 1000 + k;
      mesh.frustumCulled = false;
    }
  }

  private get meshes(): Mesh[] {
    return this.group.children as Mesh[];
  }

  /** Shows the grabbed point and the hand, seen from the eye. */
  show(point: Vector3, hand: Vector3, eye: Vector3): void {
    const far = point.distanceTo(eye);
    this.group.visible = true;
    this.knob.position.copy(point);
    this.rim.position.copy(point);
    this.hand.position.copy(hand);
    this.knob.scale.setScalar(KNOB_SIZE_RATIO * far);
    this.rim.scale.setScalar(1.35 * KNOB_SIZE_RATIO * far);
    this.hand.scale.setScalar(HAND_SIZE_RATIO * far);
    this.along.subVectors(hand, point);
    const length = this.along.length();
    for (const [mesh, width] of [
      [this.line, LINE_WIDTH_RATIO],
      [this.shade, 2.2 * LINE_WIDTH_RATIO],
    ] as const) {
      mesh.visible = length > 0.01;
      mesh.position.addVectors(point, hand).multiplyScalar(0.5);
      mesh.scale.set(width * far, Math.max(length, 1e-4), width * far);
      if (length > 1e-6)
        mesh.quaternion.setFromUnitVectors(UP_DIRECTION, this.along.clone().divideScalar(length));
    }
  }

  hide(): void {
    this.group.visible = false;
  }
}
