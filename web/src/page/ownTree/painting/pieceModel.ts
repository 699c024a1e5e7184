/** Reads the GLB of all pieces of a file. */
import {
  Box3,
  type BufferAttribute,
  type BufferGeometry,
  type InterleavedBufferAttribute,
  Mesh,
  type MeshStandardMaterial,
  type Texture,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { PieceKind } from "../pieces";
import type { PieceTable } from "./paintedKinds";

interface PiecePart {
  /** Position, uv if there is a texture, and `piece`: the row of each vertex. */
  readonly geometry: BufferGeometry;
  readonly map: Texture | null;
}

export interface PieceModel {
  readonly parts: readonly PiecePart[];
  readonly table: PieceTable;
  /** Of everything, in the file's unit. */
  readonly box: Box3;
}

const KINDS: readonly PieceKind[] = ["wood", "twigs", "leaves", "other"];

function tableOf(extras: unknown): PieceTable {
  const { part, number, kind } = (extras ?? {}) as Record<string, unknown>;
  const numbers = (value: unknown) => (Array.isArray(value) ? value.map(Number) : []);
  const kinds = Array.isArray(kind) ? kind : [];
  return {
    part: numbers(part),
    number: numbers(number),
    kind: kinds.map((one) => KINDS.find((known) => known === one) ?? "other"),
  };
}

/** Throws if the file is invalid. */
export async function readPieceModel(bytes: ArrayBuffer): Promise<PieceModel> {
  const gltf = await new GLTFLoader().parseAsync(bytes, "");
  const table = tableOf((gltf.userData as Record<string, unknown>).pieces);
  const parts: PiecePart[] = [];
  const box = new Box3();
  gltf.scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const { geometry, material } = object as Mesh<BufferGeometry, MeshStandardMaterial>;
    const rows = geometry.getAttribute("_piece") as BufferAttribute | InterleavedBufferAttribute | undefined;
    if (!rows) throw new Error("a part of the file has no pieces");
    geometry.setAttribute("piece", rows);
    geometry.deleteAttribute("_piece");
    geometry.computeBoundingBox();
    box.union(geometry.boundingBox ?? new Box3());
    parts.push({ geometry, map: material.map });
    material.dispose();
  });
  return { parts, table, box };
}
