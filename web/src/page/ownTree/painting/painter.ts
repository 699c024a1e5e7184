/** Paints pieces of a tree with the pointer. What is under it is read once per view from a picture of the rows. */
import { Group, Mesh, NearestFilter, type ShaderMaterial, Vector3, WebGLRenderTarget } from "three";
import type { PreviewStage } from "../../../scene/previewStage";
import { type Place, type RowPicture, rowsUnder } from "./brush";
import { type Paint, PaintedKinds } from "./paintedKinds";
import { PieceColours, pieceMaterial } from "./pieceMaterial";
import type { PieceModel } from "./pieceModel";

/** Wide ground is not shown whole. */
const MAX_WIDTH_RATIO = 1.2;

export interface PainterEvents {
  /** A stroke was painted, undone or redone. */
  changed(): void;
}

export class Painter {
  readonly kinds: PaintedKinds;
  paint: Paint = "wood";
  /** Radius of the brush in CSS pixels. */
  radius_px = 6;
  private readonly group = new Group();
  private readonly colours: PieceColours;
  private readonly target = new WebGLRenderTarget(1, 1, {
    minFilter: NearestFilter,
    magFilter: NearestFilter,
  });
  private picture: RowPicture | null = null;
  private last: Place | null = null;
  private readonly life = new AbortController();

  constructor(
    private readonly stage: PreviewStage,
    private readonly canvas: HTMLCanvasElement,
    private readonly model: PieceModel,
    height_m: number,
    private readonly events: PainterEvents,
  ) {
    this.kinds = new PaintedKinds(model.table);
    this.colours = new PieceColours(this.kinds.count);
    this.recolour(Array.from({ length: this.kinds.count }, (_, row) => row));
    this.place(height_m);
    stage.scene.add(this.group);
    stage.leavePointer(true);
    this.listen();
  }

  /** Scales the file's unit to metres, with the foot on the ground. */
  private place(height_m: number): void {
    const { box, parts } = this.model;
    const size = box.getSize(new Vector3());
    const middle = box.getCenter(new Vector3());
    const scale = height_m / Math.max(size.y, 1e-12);
    this.group.add(...parts.map(({ geometry, map }) => new Mesh(geometry, pieceMaterial(this.colours, map))));
    this.group.scale.setScalar(scale);
    this.group.position.set(-scale * middle.x, -scale * box.min.y, -scale * middle.z);
    const radius_m = Math.min((scale * Math.max(size.x, size.z)) / 2, MAX_WIDTH_RATIO * height_m);
    this.stage.frame({ height_m, radius_m });
  }

  private listen(): void {
    const { canvas } = this;
    const { signal } = this.life;
    canvas.addEventListener("pointerdown", (event) => this.begin(event), { signal });
    canvas.addEventListener("pointermove", (event) => this.move(event), { signal });
    for (const name of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(name, () => this.end(), { signal });
  }

  private begin(event: PointerEvent): void {
    if (!event.isPrimary) {
      this.withdraw(); // a second finger turns the tree
      return;
    }
    if (event.button !== 0) return;
    this.picture = this.rowPicture();
    this.kinds.begin(this.paint);
    this.last = this.placeOf(event);
    this.stroke(this.last);
  }

  private move(event: PointerEvent): void {
    if (!this.last || !event.isPrimary) return;
    this.stroke(this.placeOf(event));
  }

  private end(): void {
    if (!this.last) return;
    this.last = null;
    this.kinds.end();
    this.events.changed();
  }

  private withdraw(): void {
    if (!this.last) return;
    this.last = null;
    this.kinds.cancel();
    this.recolourAll();
  }

  private stroke(to: Place): void {
    const { picture, last } = this;
    if (!picture || !last) return;
    this.recolour(this.kinds.paint(rowsUnder(picture, last, to, this.radius_px)));
    this.last = to;
  }

  undo(): void {
    this.kinds.undo();
    this.recolourAll();
  }

  redo(): void {
    this.kinds.redo();
    this.recolourAll();
  }

  private recolourAll(): void {
    this.recolour(Array.from({ length: this.kinds.count }, (_, row) => row));
    this.events.changed();
  }

  private recolour(rows: readonly number[]): void {
    for (const row of rows) this.colours.set(row, this.kinds.kindOf(row));
  }

  private placeOf(event: PointerEvent): Place {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private rowPicture(): RowPicture {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.target.setSize(width, height);
    this.picking(true);
    const pixels = this.stage.read(this.group, this.target);
    this.picking(false);
    return { width, height, pixels };
  }

  private picking(value: boolean): void {
    for (const mesh of this.group.children as Mesh[])
      (mesh.material as ShaderMaterial).uniforms.picking.value = value;
  }

  dispose(): void {
    this.life.abort();
    this.stage.leavePointer(false);
    this.stage.scene.remove(this.group);
    for (const mesh of this.group.children as Mesh[]) (mesh.material as ShaderMaterial).dispose();
    for (const { geometry, map } of this.model.parts) {
      geometry.dispose();
      map?.dispose();
    }
    this.colours.texture.dispose();
    this.target.dispose();
  }
}
