/** Preview of the detected parts: wood brown, leaves green, left out red, unsure hatched. */

import type { TreeModel, TreePart } from "galewood/trees";
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  Mesh,
  MeshLambertMaterial,
  Raycaster,
  Vector2,
} from "three";
import { PreviewStage } from "../../scene/previewStage";
import { isClick } from "../ui/dom";
import type { PieceModel } from "./painting/pieceModel";
import { KIND_COLOURS, type Piece, rowsOfVertices } from "./pieces";
import { hatchUnsure, leftOutOf, type Placing } from "./split";

const TURN_RAD_S = 0.35;
const DIM_FACTOR = 0.3;
const BRIGHT_FACTOR = 1.8;

type PreviewMesh = Mesh<BufferGeometry, MeshLambertMaterial>;

export class Preview {
  readonly stage: PreviewStage;
  private tree: Group | null = null;
  private leftOut: Group | null = null;
  /** The size of the tree. */
  private frame: TreeModel | null = null;
  /** For each mesh, the row of each vertex. */
  private rows: readonly Int32Array[] = [];
  private hidden = false;
  private readonly life = new AbortController();

  /** `picked` is called with the row of a piece that is clicked. */
  constructor(canvas: HTMLCanvasElement, picked: (row: number) => void) {
    this.stage = new PreviewStage(canvas);
    const { signal } = this.life;
    let pressed: { x: number; y: number } | null = null;
    canvas.addEventListener("pointerdown", ({ clientX: x, clientY: y }) => (pressed = { x, y }), { signal });
    canvas.addEventListener(
      "pointerup",
      (event) => {
        if (!pressed || this.hidden || !isClick(pressed, event)) return; // the camera was turned
        const row = this.rowAt(canvas, event);
        if (row !== null) picked(row);
      },
      { signal },
    );
  }

  /**
   * `vertexPieces` says in runs to which row of the list the vertices of each primitive belong. Uncertain pieces are
   * hatched.
   */
  show(model: TreeModel, vertexPieces: readonly (readonly number[])[], pieces: readonly Piece[]): void {
    this.clear();
    this.tree = new Group();
    this.tree.add(...model.parts.map(meshOf));
    this.rows = model.parts.map((part, k) => rowsOfVertices(vertexPieces[k] ?? [], part.vertices));
    for (const [k, mesh] of this.meshes.entries()) hatchUnsure(mesh, this.rows[k], pieces);
    this.tree.visible = !this.hidden;
    this.stage.scene.add(this.tree);
    this.frame = model;
    this.stage.frame(model);
  }

  /** Shows what is left out beside the tree, in red. */
  showLeftOut(model: PieceModel, placing: Placing): void {
    this.leftOut = leftOutOf(model, placing);
    this.tree?.add(this.leftOut);
  }

  /** Hides the tree, because something else is drawn in its place. */
  hide(hidden: boolean): void {
    this.hidden = hidden;
    if (this.tree) this.tree.visible = !hidden;
    if (!hidden && this.frame) this.stage.frame(this.frame);
  }

  /** Renders, and rotates the tree slowly unless `still`. */
  render(dt_s: number, still: boolean): void {
    if (this.tree && !still && !this.hidden) this.tree.rotation.y += TURN_RAD_S * dt_s;
    this.stage.render();
  }

  /** Dims everything but one piece; null: nothing. Pieces that are left out are not drawn. */
  highlight(row: number | null): void {
    const drawn = row !== null && this.rows.some((rows) => rows.includes(row));
    this.meshes.forEach((mesh, k) => {
      const colours = mesh.geometry.getAttribute("color") as BufferAttribute;
      const values = colours.array as Float32Array;
      this.rows[k].forEach((found, v) => {
        values.fill(!drawn ? 1 : found === row ? BRIGHT_FACTOR : DIM_FACTOR, 3 * v, 3 * v + 3);
      });
      colours.needsUpdate = true;
    });
  }

  private get meshes(): PreviewMesh[] {
    return (this.tree?.children ?? []).filter((child) => child !== this.leftOut) as PreviewMesh[];
  }

  private rowAt(canvas: HTMLCanvasElement, event: PointerEvent): number | null {
    if (!this.tree) return null;
    const box = canvas.getBoundingClientRect();
    const place = new Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
    const ray = new Raycaster();
    this.stage.aim(ray, place);
    const [hit] = ray.intersectObjects(this.meshes, false);
    const k = this.meshes.indexOf(hit?.object as PreviewMesh);
    const row = hit?.face ? this.rows[k]?.[hit.face.a] : undefined;
    return row === undefined || row < 0 ? null : row;
  }

  private clear(): void {
    const { tree } = this;
    if (!tree) return;
    this.stage.scene.remove(tree);
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.material.map?.dispose();
      mesh.material.dispose();
    }
    this.leftOut?.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      (object.geometry as BufferGeometry).dispose();
      (object.material as MeshLambertMaterial).dispose();
    });
    this.tree = this.leftOut = null;
  }

  dispose(): void {
    this.life.abort();
    this.clear();
    this.stage.dispose();
  }
}

function meshOf({ kind, vertices, position, normal, uv, index, material }: TreePart): PreviewMesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", position);
  geometry.setAttribute("normal", normal);
  if (uv) geometry.setAttribute("uv", uv);
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * vertices).fill(1), 3));
  geometry.setIndex(index);
  const leaves = kind === "leaves";
  const look = new MeshLambertMaterial({
    color: KIND_COLOURS[kind],
    vertexColors: true,
    alphaMap: null,
    map: leaves ? material.map : null,
    alphaTest: leaves && material.map ? 0.42 : 0,
    side: DoubleSide,
  });
  return new Mesh(geometry, look);
}
