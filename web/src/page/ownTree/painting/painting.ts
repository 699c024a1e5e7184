/** Painting in the dialog of an upload: fetches all pieces, and turns strokes into choices. */
import type { PreviewStage } from "../../../scene/previewStage";
import { fetchPieces } from "../../server/api";
import { make } from "../../ui/dom";
import type { Piece, PieceChoices } from "../pieces";
import { PaintBar } from "./paintBar";
import { Painter } from "./painter";
import { readPieceModel } from "./pieceModel";

export interface PaintingHost {
  readonly stage: PreviewStage;
  readonly canvas: HTMLCanvasElement;
  /** Holds the controls. */
  readonly place: HTMLElement;
}

export class Painting {
  private readonly bar: PaintBar;
  private readonly ring = make("div", "", "own-tree-brush");
  private readonly life = new AbortController();

  private constructor(
    private readonly host: PaintingHost,
    private readonly painter: Painter,
    private readonly pieces: readonly Piece[],
    /** Called with the new choices, or null if the pieces stay as they are. */
    private readonly finished: (choices: PieceChoices | null) => void,
    events: { changed(): void },
  ) {
    this.bar = new PaintBar({
      paint: (kind) => {
        painter.paint = kind;
      },
      size: (radius_px) => {
        painter.radius_px = radius_px;
      },
      undo: () => painter.undo(),
      redo: () => painter.redo(),
      finish: (keep) => this.finish(keep),
    });
    events.changed = () => this.show();
    this.ring.setAttribute("aria-hidden", "true");
    this.ring.hidden = true;
    host.place.append(this.ring, this.bar.root);
    this.follow();
    this.bar.focus();
  }

  /** Fetches the pieces of an upload and starts painting. Throws a Problem. */
  static async start(
    host: PaintingHost,
    upload: { readonly id: string; readonly height_m: number; readonly pieces: readonly Piece[] },
    finished: (choices: PieceChoices | null) => void,
  ): Promise<Painting> {
    const model = await readPieceModel(await fetchPieces(upload.id));
    const events = { changed: () => {} };
    const relay = { changed: () => events.changed() };
    const painter = new Painter(host.stage, host.canvas, model, upload.height_m, relay);
    return new Painting(host, painter, upload.pieces, finished, events);
  }

  /** A ring of the brush's size follows the pointer. */
  private follow(): void {
    const { canvas } = this.host;
    const { signal } = this.life;
    const show = (event: PointerEvent) => {
      const radius = this.painter.radius_px;
      const [x, y] = [event.offsetX + canvas.offsetLeft - radius, event.offsetY + canvas.offsetTop - radius];
      this.ring.hidden = false;
      this.ring.style.width = this.ring.style.height = `${2 * radius}px`;
      this.ring.style.transform = `translate(${x}px, ${y}px)`;
    };
    canvas.addEventListener("pointermove", show, { signal });
    canvas.addEventListener("pointerleave", () => (this.ring.hidden = true), { signal });
  }

  /** Handles a key of the dialog; returns whether it was one of painting. */
  key(event: KeyboardEvent): boolean {
    return this.bar.key(event);
  }

  private show(): void {
    const { kinds } = this.painter;
    this.bar.show(kinds.changed.length, kinds.canUndo, kinds.canRedo);
  }

  /** Ends painting; `keep`: with the painted pieces. */
  finish(keep: boolean): void {
    const { kinds } = this.painter;
    const choices = keep && kinds.changed.length > 0 ? kinds.choices(this.pieces) : null;
    this.dispose();
    this.finished(choices);
  }

  dispose(): void {
    this.life.abort();
    this.painter.dispose();
    this.ring.remove();
    this.bar.root.remove();
  }
}
