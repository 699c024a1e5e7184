/** Gust fronts on their way: pale bands on the ground that travel with them. */

import { FRONT_LIFE_S, type Front, frontExtent, MOST_FRONTS, travelled_m } from "galewood/wind";
import { BufferAttribute, BufferGeometry, Group, Mesh, MeshBasicMaterial } from "three";
import { groundHeight_m } from "../ground/landscape";

const COLUMN_COUNT = 40;
/** Rows of the band: distance from its middle (m), and opacity. */
const ROWS = [
  [-5, 0],
  [-1.2, 0.22],
  [0, 0.34],
  [0.7, 0],
] as const;
const ABOVE_M = 0.12;
/** The band bends back towards its ends, by this share of its width. */
const BEND_SHARE = 0.35;

class Band {
  readonly mesh: Mesh<BufferGeometry, MeshBasicMaterial>;

  constructor() {
    const count = (COLUMN_COUNT + 1) * ROWS.length;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * count), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(4 * count).fill(1), 4));
    const quads = Array.from({ length: COLUMN_COUNT }, (_, column) =>
      ROWS.slice(1).flatMap((_row, row) => {
        const a = column * ROWS.length + row;
        const b = a + ROWS.length;
        return [a, b, a + 1, a + 1, b, b + 1];
      }),
    );
    geometry.setIndex(quads.flat());
    const material = new MeshBasicMaterial({
      vertexColors: true,
      transparent: true,
      depthWrite: false,
      toneMapped: false,
      side: 2,
      polygonOffset: true,
      polygonOffsetFactor: -4,
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  show(front: Front, age_s: number): void {
    const path_m = travelled_m(front, age_s);
    this.mesh.visible = path_m !== null;
    if (path_m === null) return;
    const heading = (front.direction_deg * Math.PI) / 180;
    const [cos, sin] = [Math.cos(heading), Math.sin(heading)];
    const { width_m, left } = frontExtent(path_m);
    const { position, color } = this.mesh.geometry.attributes as Record<string, BufferAttribute>;
    for (let column = 0; column <= COLUMN_COUNT; column++) {
      const s = (2 * column) / COLUMN_COUNT - 1;
      const rest = (1 - s * s) ** 2;
      for (const [row, [offset_m, opacity]] of ROWS.entries()) {
        const along = path_m - BEND_SHARE * width_m * s * s + offset_m;
        const x = front.x_m + along * cos - s * width_m * sin;
        const z = front.z_m + along * sin + s * width_m * cos;
        const at = column * ROWS.length + row;
        position.setXYZ(at, x, groundHeight_m(x, z) + ABOVE_M, z);
        color.setW(at, opacity * rest * left * Math.min(1, 2 * age_s));
      }
    }
    position.needsUpdate = true;
    color.needsUpdate = true;
  }
}

export class FrontBands {
  readonly group = new Group();
  private readonly bands = Array.from({ length: MOST_FRONTS }, () => new Band());

  constructor() {
    this.group.add(...this.bands.map(({ mesh }) => mesh));
  }

  /** Shows the fronts of a wind at a time. */
  show(fronts: readonly Front[], time_s: number): void {
    for (const [k, band] of this.bands.entries()) {
      const front = fronts[k];
      const age_s = front ? time_s - front.since_s : FRONT_LIFE_S;
      if (front && age_s < FRONT_LIFE_S) band.show(front, age_s);
      else band.mesh.visible = false;
    }
  }
}
