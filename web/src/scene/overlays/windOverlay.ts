/** Arrows on the ground that show the wind: longer and warmer in gusts, shorter and bluer in lulls. */

import type { WindField } from "galewood/wind";
import {
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  type Vector3,
} from "three";
import { groundHeight_m } from "../ground/landscape";

const SIDE_ARROWS = 30;
const SPACING_M = 5;
const ABOVE_M = 0.5;
const LULL_COLOUR = new Color(0x2f6fd0);
const MEAN_COLOUR = new Color(0xf4f1e6);
const GUST_COLOUR = new Color(0xff7a1a);

/** A flat arrow along x, 1 m long, centred at the origin. */
function arrow(): BufferGeometry {
  const outline = [-0.5, -0.05, 0.15, -0.05, 0.15, 0.05, -0.5, 0.05, 0.15, -0.16, 0.5, 0, 0.15, 0.16];
  const corners = Array.from({ length: 7 }, (_, i) => [outline[2 * i], 0, outline[2 * i + 1]]).flat();
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(corners, 3));
  geometry.setIndex([0, 2, 1, 0, 3, 2, 4, 6, 5]);
  return geometry;
}

export class WindOverlay {
  readonly mesh = new InstancedMesh(
    arrow(),
    new MeshBasicMaterial({ transparent: true, opacity: 0.85, depthWrite: false, side: 2 }),
    SIDE_ARROWS * SIDE_ARROWS,
  );
  private readonly x = new Float64Array(SIDE_ARROWS * SIDE_ARROWS);
  private readonly z = new Float64Array(SIDE_ARROWS * SIDE_ARROWS);
  private readonly ground_m = new Float32Array(SIDE_ARROWS * SIDE_ARROWS);
  private readonly velocityX = new Float64Array(SIDE_ARROWS * SIDE_ARROWS);
  private readonly velocityZ = new Float64Array(SIDE_ARROWS * SIDE_ARROWS);
  private readonly matrix = new Matrix4();
  private readonly colour = new Color();
  private centre = "";

  constructor() {
    this.mesh.visible = false;
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 8;
    this.mesh.castShadow = false;
  }

  get visible(): boolean {
    return this.mesh.visible;
  }

  set visible(visible: boolean) {
    this.mesh.visible = visible;
  }

  /** Places the arrows around a position and aligns them with the current wind. */
  update(field: WindField, time_s: number, around: Vector3): void {
    if (!this.visible) return;
    this.place(Math.round(around.x / SPACING_M), Math.round(around.z / SPACING_M));
    const moment = field.at(time_s);
    field.velocity(this.x, this.z, moment, this.velocityX, this.velocityZ);
    const { mean_speed_m_s, gustiness } = moment.wind;
    const spread = Math.max(0.3, 0.5 * mean_speed_m_s * gustiness);
    for (let i = 0; i < this.x.length; i++) this.turn(i, mean_speed_m_s, spread);
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }

  /** Snaps to a lattice, so that arrows stay in place while the camera moves. */
  private place(column: number, row: number): void {
    const centre = `${column} ${row}`;
    if (centre === this.centre) return;
    this.centre = centre;
    for (let i = 0; i < this.x.length; i++) {
      this.x[i] = (column + (i % SIDE_ARROWS) - SIDE_ARROWS / 2) * SPACING_M;
      this.z[i] = (row + Math.floor(i / SIDE_ARROWS) - SIDE_ARROWS / 2) * SPACING_M;
      this.ground_m[i] = groundHeight_m(this.x[i], this.z[i]) + ABOVE_M;
    }
  }

  private turn(i: number, mean_m_s: number, spread_m_s: number): void {
    const vx = this.velocityX[i];
    const vz = this.velocityZ[i];
    const speed = Math.hypot(vx, vz);
    const length_m = Math.min(1.25 * SPACING_M, 0.35 * speed);
    const [c, s] = speed > 0 ? [vx / speed, vz / speed] : [1, 0];
    const width_m = 0.8 + 0.45 * length_m;
    this.matrix.set(
      c * length_m,
      0,
      -s * width_m,
      this.x[i],
      0,
      1,
      0,
      this.ground_m[i],
      s * length_m,
      0,
      c * width_m,
      this.z[i],
      0,
      0,
      0,
      1,
    );
    this.mesh.setMatrixAt(i, this.matrix);
    const gust = Math.max(-1, Math.min(1, (speed - mean_m_s) / spread_m_s));
    this.colour.copy(MEAN_COLOUR).lerp(gust < 0 ? LULL_COLOUR : GUST_COLOUR, Math.abs(gust));
    this.mesh.setColorAt(i, this.colour);
  }
}
