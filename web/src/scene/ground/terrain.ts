/** The ground: a disc, fine in the centre and coarse at the horizon. groundMaterial.ts holds its colour. */
import { BufferAttribute, BufferGeometry, Mesh, type MeshLambertMaterial } from "three";
import type { Pictures } from "../textures/pictures";
import { vertexNormals } from "../treeModel/points";
import { groundMaterial } from "./groundMaterial";
import { glade, groundHeight_m } from "./landscape";

const RING_COUNT = 150;
const SECTOR_COUNT = 192;
/** Distance at which the land ends, m from its centre. */
export const LAND_REACH_M = 1700;

/** Spacing of the rings: about 1 m in the centre, 60 m at the rim. */
const ringRadius_m = (ring: number) =>
  LAND_REACH_M * (0.12 * (ring / RING_COUNT) + 0.88 * (ring / RING_COUNT) ** 4);

function discGeometry(): BufferGeometry {
  const columns = SECTOR_COUNT + 1;
  const position = new Float32Array((RING_COUNT + 1) * columns * 3);
  const meadow = new Float32Array((RING_COUNT + 1) * columns);
  for (let sector = 0; sector <= SECTOR_COUNT; sector++) {
    const angle = (2 * Math.PI * sector) / SECTOR_COUNT;
    const [across, along] = [Math.cos(angle), Math.sin(angle)];
    for (let ring = 0; ring <= RING_COUNT; ring++) {
      const x = ringRadius_m(ring) * across;
      const z = ringRadius_m(ring) * along;
      const v = ring * columns + sector;
      position[3 * v] = x;
      position[3 * v + 1] = groundHeight_m(x, z);
      position[3 * v + 2] = z;
      meadow[v] = glade(x, z);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("aMeadow", new BufferAttribute(meadow, 1));
  const index = ringIndex(RING_COUNT, SECTOR_COUNT);
  geometry.setIndex(new BufferAttribute(index, 1));
  geometry.setAttribute("normal", new BufferAttribute(vertexNormals(position, index), 3));
  return geometry;
}

/** Triangles of rings of vertices around a centre, seen from above; the first column is repeated at the end. */
export function ringIndex(rings: number, sectors: number): Uint32Array {
  const columns = sectors + 1;
  const index = new Uint32Array(6 * rings * sectors);
  let at = 0;
  for (let ring = 0; ring < rings; ring++) {
    for (let sector = 0; sector < sectors; sector++) {
      const a = ring * columns + sector;
      const b = a + columns;
      index[at] = a;
      index[at + 1] = index[at + 4] = a + 1;
      index[at + 2] = index[at + 3] = b;
      index[at + 5] = b + 1;
      at += 6;
    }
  }
  return index;
}

export class Terrain {
  /** A point until it is given its shape. */
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;

  constructor(pictures: Pictures) {
    // three.js chooses the code of the shader by the attributes.
    const unshaped = new BufferGeometry();
    for (const name of ["position", "normal"]) {
      unshaped.setAttribute(name, new BufferAttribute(new Float32Array(3), 3));
    }
    this.mesh = new Mesh(unshaped, groundMaterial(pictures));
    this.mesh.receiveShadow = true;
    // Drawn after the trees, which hide most of it.
    this.mesh.renderOrder = 5;
    this.mesh.matrixAutoUpdate = false;
  }

  shape(): void {
    this.mesh.geometry.dispose();
    this.mesh.geometry = discGeometry();
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
