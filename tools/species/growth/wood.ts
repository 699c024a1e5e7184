import { Vector3 } from "three";
import { branches, type SkeletonNode } from "./skeleton";
import type { SurfaceMesh } from "./surface";

/** Tessellation of the wood tubes. */
export interface WoodCut {
  /** Corners of a cross-section of trunk, boughs and twigs. */
  segments: readonly number[];
  /** Width and height of one bark tile, m. */
  bark_tile_m: readonly [number, number];
}

interface Ring {
  centre: Vector3;
  radius: number;
  side: Vector3;
  across: Vector3;
  tangent: Vector3;
  along_m: number;
}

/** Closed tubes, one per branch; a side branch starts on the axis of its parent. */
export function woodMesh(nodes: readonly SkeletonNode[], cut: WoodCut): SurfaceMesh {
  const mesh: SurfaceMesh = { positions: [], normals: [], uvs: [], indices: [] };
  for (const ids of branches(nodes)) {
    const segments = cut.segments[nodes[ids[0]].level];
    addTube(mesh, rings(nodes, ids, segments), segments, cut.bark_tile_m);
  }
  return mesh;
}

/** Rings carried along the branch without twist (double reflection is not needed at these bends). */
function rings(nodes: readonly SkeletonNode[], ids: readonly number[], segments: number): Ring[] {
  // An inscribed polygon would be too thin: give it the area of the circle.
  const fullArea = Math.sqrt((2 * Math.PI) / (segments * Math.sin((2 * Math.PI) / segments)));
  const points = ids.map((id) => nodes[id].position);
  let side = new Vector3(1, 0, 0);
  let along_m = 0;
  return ids.map((id, i) => {
    const tangent = nodes[id].parent < 0 ? new Vector3(0, 1, 0) : tangentAt(points, i);
    if (i === 0 && Math.abs(tangent.x) > 0.9) side = new Vector3(0, 0, 1);
    side = side.clone().addScaledVector(tangent, -side.dot(tangent)).normalize();
    const across = new Vector3().crossVectors(side, tangent);
    if (i > 0) along_m += points[i].distanceTo(points[i - 1]);
    return { centre: points[i], radius: nodes[id].radius * fullArea, side, across, tangent, along_m };
  });
}

function tangentAt(points: readonly Vector3[], i: number): Vector3 {
  const ahead = points[Math.min(i + 1, points.length - 1)];
  return ahead
    .clone()
    .sub(points[Math.max(i - 1, 0)])
    .normalize();
}

function addTube(mesh: SurfaceMesh, tube: Ring[], segments: number, tile_m: readonly [number, number]): void {
  const repeats = Math.max(1, Math.round((2 * Math.PI * tube[0].radius) / tile_m[0]));
  const first = mesh.positions.length / 3;
  for (const ring of tube) addRing(mesh, ring, segments, repeats, tile_m[1]);
  const width = segments + 1;
  for (let i = 0; i + 1 < tube.length; i++) {
    for (let j = 0; j < segments; j++) {
      const a = first + i * width + j;
      mesh.indices.push(a, a + width, a + 1, a + 1, a + width, a + width + 1);
    }
  }
  addCap(mesh, tube[0], first, segments, -1);
  addCap(mesh, tube[tube.length - 1], first + (tube.length - 1) * width, segments, 1);
}

function addRing(
  mesh: SurfaceMesh,
  ring: Ring,
  segments: number,
  repeats: number,
  tile_height_m: number,
): void {
  for (let j = 0; j <= segments; j++) {
    // The seam repeats the first corner exactly, so that welding closes the tube.
    const angle = (2 * Math.PI * (j % segments)) / segments;
    const normal = ring.side
      .clone()
      .multiplyScalar(Math.cos(angle))
      .addScaledVector(ring.across, Math.sin(angle));
    const point = ring.centre.clone().addScaledVector(normal, ring.radius);
    mesh.positions.push(point.x, point.y, point.z);
    mesh.normals.push(normal.x, normal.y, normal.z);
    mesh.uvs.push((j / segments) * repeats, ring.along_m / tile_height_m);
  }
}

/** Closes an end: flat at the base (`sense` -1), blunt at the tip (`sense` 1). */
function addCap(mesh: SurfaceMesh, ring: Ring, first: number, segments: number, sense: 1 | -1): void {
  const apex = ring.centre.clone().addScaledVector(ring.tangent, sense > 0 ? ring.radius * 1.5 : 0);
  const id = mesh.positions.length / 3;
  mesh.positions.push(apex.x, apex.y, apex.z);
  mesh.normals.push(ring.tangent.x * sense, ring.tangent.y * sense, ring.tangent.z * sense);
  mesh.uvs.push(mesh.uvs[first * 2] + 0.5, mesh.uvs[first * 2 + 1]);
  for (let j = 0; j < segments; j++) {
    if (sense > 0) mesh.indices.push(first + j, id, first + j + 1);
    else mesh.indices.push(first + j, first + j + 1, id);
  }
}
