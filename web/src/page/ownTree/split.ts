/** How the split of an upload is drawn: uncertain pieces hatched, pieces that are left out in red. */
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  Mesh,
  MeshLambertMaterial,
  type Object3D,
  Vector3,
} from "three";
import { make } from "../ui/dom";
import type { PieceModel } from "./painting/pieceModel";
import { KIND_COLOURS, type Piece, swatchOf } from "./pieces";

const STRIPES_GLSL = /* glsl */ `#include <dithering_fragment>
if (hatched > 0.5 && fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0) < 0.34) gl_FragColor.rgb *= 0.25;`;

/** From the coordinates of the file, y up, to those of the tree. */
export interface Placing {
  readonly origin: readonly [number, number, number];
  readonly metresPerUnit: number;
}

const isUnsure = (piece: Piece | undefined): boolean => piece !== undefined && !piece.sure && !piece.chosen;

/** For each vertex 1 if its piece is uncertain, else 0. Pure. */
export const unsureVertices = (rows: Int32Array, pieces: readonly Piece[]): Float32Array =>
  Float32Array.from(rows, (row) => (isUnsure(pieces[row]) ? 1 : 0));

/** Hatches the uncertain pieces of a mesh. */
export function hatchUnsure(
  mesh: Mesh<BufferGeometry, MeshLambertMaterial>,
  rows: Int32Array,
  pieces: readonly Piece[],
): void {
  if (!pieces.some(isUnsure)) return;
  mesh.geometry.setAttribute("unsure", new BufferAttribute(unsureVertices(rows, pieces), 1));
  mesh.material.onBeforeCompile = (shader) => {
    shader.vertexShader = `attribute float unsure;\nvarying float hatched;\n${shader.vertexShader}`.replace(
      "#include <begin_vertex>",
      "#include <begin_vertex>\nhatched = unsure;",
    );
    shader.fragmentShader = `varying float hatched;\n${shader.fragmentShader}`.replace(
      "#include <dithering_fragment>",
      STRIPES_GLSL,
    );
  };
}

/** The faces whose row is left out. Pure. */
export function leftOutFaces(
  index: ArrayLike<number>,
  row: (vertex: number) => number,
  kinds: readonly string[],
): number[] {
  const kept: number[] = [];
  for (let k = 0; k + 2 < index.length; k += 3)
    if (kinds[row(index[k])] === "other") kept.push(index[k], index[k + 1], index[k + 2]);
  return kept;
}

/** What is left out, in red, where it stands beside the tree. */
export function leftOutOf({ parts, table }: PieceModel, { origin, metresPerUnit }: Placing): Group {
  const group = new Group();
  const look = new MeshLambertMaterial({ color: KIND_COLOURS.other, side: DoubleSide, flatShading: true });
  for (const { geometry, map } of parts) {
    map?.dispose();
    const rows = geometry.getAttribute("piece");
    const faces = leftOutFaces(
      geometry.index?.array ?? [],
      (vertex) => Math.round(rows.getX(vertex)),
      table.kind,
    );
    if (faces.length === 0) continue;
    const drawn = new BufferGeometry();
    drawn.setAttribute("position", geometry.getAttribute("position"));
    drawn.setIndex(faces);
    group.add(new Mesh(drawn, look));
  }
  group.scale.setScalar(metresPerUnit);
  group.position.copy(new Vector3(...origin).multiplyScalar(-metresPerUnit));
  return group as Object3D as Group;
}

/** What the colours mean. */
export function splitLegend(): HTMLElement {
  const legend = make("p", "", "own-tree-legend");
  const hatched = make("span", "", "own-tree-swatch hatched");
  hatched.setAttribute("aria-hidden", "true");
  for (const [swatch, words] of [
    [swatchOf("wood"), "wood"],
    [swatchOf("leaves"), "leaves"],
    [swatchOf("other"), "left out"],
    [hatched, "unsure"],
  ] as const) {
    const entry = make("span");
    entry.append(swatch, words);
    legend.append(entry);
  }
  return legend;
}
