/** An anemometer on a mast: three cups that turn with the wind, and a vane. */
import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshLambertMaterial, SphereGeometry } from "three";
import { groundHeight_m } from "../ground/landscape";

const MAST_M = 3;
const ARM_M = 0.55;
/** Cup speed relative to the wind speed. */
const CUP_FACTOR = 1 / 3;

export class Mast {
  readonly group = new Group();
  private readonly rotor = new Group();
  private readonly metal = new MeshLambertMaterial({ color: 0xe9e4d8 });
  private readonly red = new MeshLambertMaterial({ color: 0xd8432f });
  private readonly pole = new CylinderGeometry(0.05, 0.08, MAST_M, 8);
  private readonly arm = new CylinderGeometry(0.025, 0.025, ARM_M, 6);
  private readonly cup = new SphereGeometry(0.17, 12, 8, 0, Math.PI);
  private readonly cap = new ConeGeometry(0.11, 0.2, 8);

  constructor() {
    const mast = new Mesh(this.pole, this.metal);
    mast.position.y = MAST_M / 2;
    const top = new Mesh(this.cap, this.metal);
    top.position.y = MAST_M + 0.15;
    this.rotor.position.y = MAST_M + 0.05;
    for (let k = 0; k < 3; k++) this.rotor.add(this.spoke((k * 2 * Math.PI) / 3));
    this.group.add(mast, top, this.rotor);
    this.group.traverse((part) => {
      part.castShadow = true;
    });
    this.group.visible = false;
  }

  private spoke(angle: number): Group {
    const spoke = new Group();
    const bar = new Mesh(this.arm, this.metal);
    bar.rotation.z = Math.PI / 2;
    bar.position.x = ARM_M / 2;
    const bowl = new Mesh(this.cup, this.red);
    bowl.position.x = ARM_M;
    spoke.add(bar, bowl);
    spoke.rotation.y = angle;
    return spoke;
  }

  place(x: number, z: number): void {
    this.group.position.set(x, groundHeight_m(x, z), z);
    this.group.visible = true;
  }

  hide(): void {
    this.group.visible = false;
  }

  turn(speed_m_s: number, dt_s: number): void {
    this.rotor.rotation.y -= ((CUP_FACTOR * speed_m_s) / ARM_M) * dt_s;
  }
}
