/** A tree that is deformed on the CPU, for the comparison view. */

import type { TableMotion } from "galewood/client";
import { NodePose } from "galewood/motion";
import type { TreeModel, TreePart } from "galewood/trees";
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  FrontSide,
  Group,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
} from "three";

const EXACT_COLOUR = new Color(1, 1, 1);
const ERROR_COLOUR = new Color(1, 0.12, 0.05);
const GHOST_COLOUR = 0x8fd3ff;

interface Piece {
  readonly rest: Float32Array;
  readonly firstVertex: number;
  readonly geometry: BufferGeometry;
}

/** A tree at the origin: either solid and coloured by its error, or a transparent ghost. */
export class BentTree {
  readonly group = new Group();
  readonly pose: NodePose;
  private readonly pieces: Piece[] = [];
  private readonly materials: Material[] = [];

  constructor(
    model: TreeModel,
    private readonly motion: TableMotion,
    ghost: boolean,
  ) {
    this.pose = new NodePose(motion);
    let firstVertex = 0;
    for (const part of model.parts) {
      this.add(part, firstVertex, ghost);
      firstVertex += part.vertices;
    }
  }

  private add(part: TreePart, firstVertex: number, ghost: boolean): void {
    const rest = part.position.array as Float32Array;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(rest.slice(), 3));
    geometry.setAttribute("normal", part.normal);
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(rest.length).fill(1), 3));
    if (part.uv) geometry.setAttribute("uv", part.uv);
    geometry.setIndex(part.index);
    const material = ghost ? ghostMaterial(part) : solidMaterial(part);
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false; // it moves beyond the bounds of its rest shape
    if (ghost) mesh.renderOrder = 1;
    this.group.add(mesh);
    this.materials.push(material);
    this.pieces.push({ rest, firstVertex, geometry });
  }

  /** Moves the tree to the pose q (modes), magnified by `times`. */
  bend(q: Float32Array, times: number): void {
    this.pose.take(q, 0, times);
  }

  /** Moves every vertex with its joint. */
  show(): void {
    const place = new Float64Array(3);
    for (const { rest, firstVertex, geometry } of this.pieces) {
      const position = geometry.getAttribute("position") as BufferAttribute;
      const out = position.array as Float32Array;
      for (let v = 0; v * 3 < rest.length; v++) {
        this.pose.place(firstVertex + v, rest[3 * v], rest[3 * v + 1], rest[3 * v + 2], place);
        out.set(place, 3 * v);
      }
      position.needsUpdate = true;
    }
  }

  /** Colours each vertex by the distance of its joint from the reference solution; full red at `worst_m`. */
  paint(reference: NodePose, worst_m: number): void {
    const { vertexJoint } = this.motion;
    const a = this.pose.jointMoved;
    const b = reference.jointMoved;
    const colour = new Color();
    for (const { rest, firstVertex, geometry } of this.pieces) {
      const attribute = geometry.getAttribute("color") as BufferAttribute;
      for (let v = 0; v * 3 < rest.length; v++) {
        const n = 3 * vertexJoint[firstVertex + v];
        const off = Math.hypot(a[n] - b[n], a[n + 1] - b[n + 1], a[n + 2] - b[n + 2]);
        colour.lerpColors(EXACT_COLOUR, ERROR_COLOUR, Math.min(1, off / worst_m));
        attribute.setXYZ(v, colour.r, colour.g, colour.b);
      }
      attribute.needsUpdate = true;
    }
  }

  dispose(): void {
    for (const { geometry } of this.pieces) geometry.dispose();
    for (const material of this.materials) material.dispose();
  }
}

function solidMaterial({ material, kind }: TreePart): Material {
  const leaves = kind === "leaves";
  return new MeshLambertMaterial({
    map: material.map,
    color: leaves ? 0xd7c9a0 : 0xd9cbb8,
    vertexColors: true,
    side: leaves ? DoubleSide : FrontSide,
    alphaTest: leaves && material.map ? 0.42 : 0,
  });
}

function ghostMaterial({ material, kind }: TreePart): Material {
  const leaves = kind === "leaves";
  return new MeshBasicMaterial({
    map: leaves ? material.map : null,
    color: GHOST_COLOUR,
    transparent: true,
    opacity: leaves ? 0.16 : 0.4,
    depthWrite: false,
    alphaTest: leaves && material.map ? 0.1 : 0,
  });
}
