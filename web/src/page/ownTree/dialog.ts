/** Shows the detected parts of an uploaded tree, ready to correct before its motion is computed. */
import {
  type Assumptions,
  changeAssumptions,
  deleteTree,
  fetchModel,
  fetchPieces,
  knownSpecies,
  Problem,
  type ReportedTree,
  startBuild,
  thumbnailUrl,
} from "../server/api";
import { IMPORT_LIMITS } from "../server/schema";
import { make } from "../ui/dom";
import { displayName } from "../ui/words";
import type { OwnUploads } from "../uploads/ownUploads";
import { type Assumed, assumedOf } from "./assumed";
import { Computing } from "./computing";
import { expectedMotionOf } from "./expectedMotion";
import { button, numberField, row, select } from "./formRows";
import { LivelinessChoice } from "./livelinessChoice";
import { Painting } from "./painting/painting";
import { readPieceModel } from "./painting/pieceModel";
import { type PieceChoices, PieceList } from "./pieces";
import { Preview } from "./preview";
import { scanFields } from "./scanFields";
import { SeveralTrees } from "./severalTrees";
import { splitLegend } from "./split";
import { addedWoodRow, treeRows } from "./treeRows";
import { upAxisRow } from "./upAxis";

const still = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

export class OwnTreeDialog {
  private readonly dialog = make("dialog", "", "own-tree");
  private readonly canvas = make("canvas", "", "own-tree-stage");
  /** The picture and its controls. */
  private readonly view = make("div", "", "own-tree-view");
  /** The tree in its own colours, beside the split. */
  private readonly picture = make("img", "", "own-tree-picture");
  private readonly paint = button("Paint pieces", () => void this.startPainting());
  private readonly title = make("h2", "Your tree");
  private readonly side = make("section");
  private readonly form = make("div", "", "own-tree-form");
  private readonly liveliness = new LivelinessChoice();
  private readonly message = make("p", "", "own-tree-message");
  private readonly go = make("button", "Add to the forest", "primary");
  private readonly preview: Preview;
  private readonly pieces = new PieceList(
    (choices) => void this.change(choices),
    (entry) => this.preview.highlight(entry),
  );
  private settle: (started: boolean) => void = () => {};
  private computing: Computing | null = null;
  private painting: Painting | null = null;
  private several: SeveralTrees | null = null;
  /** The import that painting has started. */
  private changing: Promise<boolean> = Promise.resolve(true);
  private stopWatching = () => {};
  private started = false;
  private lacksWood = false;
  private frame = 0;
  private last_ms = 0;

  constructor(
    private tree: ReportedTree,
    private readonly uploads: OwnUploads,
  ) {
    this.title.id = "own-tree-heading";
    this.dialog.setAttribute("aria-labelledby", this.title.id);
    this.message.setAttribute("role", "status");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute(
      "aria-label",
      "Detected parts: wood in brown, leaves in green, left out in red, unsure hatched",
    );
    const away = button("Discard", () => this.dialog.close());
    this.go.type = "button";
    this.go.addEventListener("click", () => void this.compute());
    const foot = make("footer");
    foot.append(away, this.go);
    this.side.append(this.form, this.message, foot);
    const body = make("div", "", "own-tree-body");
    this.paint.hidden = true;
    this.picture.hidden = true;
    this.picture.alt = "The tree in the colours of its file";
    this.view.append(this.canvas, this.picture, splitLegend(), this.paint);
    body.append(this.view, this.side);
    this.dialog.append(this.title, body);
    this.dialog.addEventListener("keydown", (event) => this.key(event));
    this.dialog.addEventListener("close", () => void this.closed());
    document.body.append(this.dialog);
    this.preview = new Preview(this.canvas, (entry) => this.pieces.focus(entry));
  }

  /** Resolves when the dialog closes, with whether the computation was started; otherwise the tree was deleted. */
  async open(): Promise<boolean> {
    const over = new Promise<boolean>((resolve) => {
      this.settle = resolve;
    });
    this.dialog.showModal();
    this.go.focus();
    this.last_ms = performance.now();
    this.frame = requestAnimationFrame((now) => this.turn(now));
    await this.show();
    return over;
  }

  private turn(now_ms: number): void {
    this.frame = requestAnimationFrame((now) => this.turn(now));
    this.preview.render(Math.min(0.1, Math.max(0, (now_ms - this.last_ms) / 1000)), still());
    this.last_ms = now_ms;
  }

  /** Shows the tree with the current assumptions. */
  private async show(): Promise<void> {
    const { tree } = this;
    this.title.textContent = displayName(tree);
    const assumed = assumedOf(tree.report);
    const species = await knownSpecies().catch(() => []);
    this.liveliness.show(expectedMotionOf(tree.report));
    this.form.replaceChildren(
      ...list("own-tree-questions", assumed.questions),
      ...this.fields(assumed, species),
      this.liveliness.root,
      ...list("own-tree-warnings", assumed.warnings),
    );
    if (!tree.mesh_sha256) return;
    try {
      const model = await fetchModel(tree.mesh_sha256, { varied: false, evergreen: tree.evergreen });
      this.preview.show(model, assumed.vertexPieces, assumed.pieces);
      this.picture.src = thumbnailUrl(tree);
      this.picture.hidden = false;
      if (assumed.pieces.some(({ kind }) => kind === "other"))
        this.preview.showLeftOut(await readPieceModel(await fetchPieces(tree.id)), assumed.placing);
    } catch (error) {
      this.say(error);
    }
  }

  private fields(assumed: Assumed, species: readonly { id: string; name: string }[]): HTMLElement[] {
    const woods = species.map(({ id, name }) => [id, name] as const);
    const wood = select(woods, assumed.species.value || "default", (value) =>
      this.change({ species: value }),
    );
    const height = numberField(assumed.height_m, { ...IMPORT_LIMITS.height_m, step: 0.1 }, (value) =>
      this.change({ height_m: value }),
    );
    this.lacksWood ||= assumed.addedWood !== null; // the choice stays once wood has been left out
    const axis = upAxisRow(assumed, (value) => void this.change({ up_axis: value }));
    return [
      ...(assumed.axis.unsure ? [axis] : []), // a question comes first
      row("Wood species", wood, assumed.species.reason),
      row("Height (m)", height, assumed.size),
      ...(assumed.axis.unsure ? [] : [axis]),
      ...treeRows(
        assumed.trees,
        (one) => void this.change(one),
        () => this.importAll(assumed),
      ),
      ...(this.lacksWood ? [addedWoodRow(assumed.addedWood, (one) => void this.change(one))] : []),
      ...(assumed.scan ? scanFields(assumed.scan, (one) => void this.change(one)) : [this.detected(assumed)]),
    ];
  }

  /** Imports every tree of the file as an upload of its own. */
  private importAll(assumed: Assumed): void {
    this.painting?.finish(false);
    const { tree, uploads } = this;
    const several = new SeveralTrees(
      { tree, assumed, uploads, settings: this.liveliness.settings },
      () => this.dialog.close(),
      () => this.dialog.close(),
    );
    this.several = several;
    this.paint.hidden = true;
    this.side.replaceChildren(several.root);
    void several.run();
  }

  /** The detected pieces. */
  private detected({ pieces, trees }: Assumed): HTMLElement {
    this.pieces.show(pieces, trees.find((tree) => tree.taken)?.number ?? 1);
    this.paint.hidden = this.painting !== null;
    return this.pieces.root;
  }

  /** Starts painting pieces in the picture. */
  private async startPainting(): Promise<void> {
    const { tree } = this;
    const { height_m, pieces } = assumedOf(tree.report);
    this.busy("Reading all pieces");
    this.paint.disabled = true;
    try {
      const host = { stage: this.preview.stage, canvas: this.canvas, place: this.view };
      const upload = { id: tree.id, height_m, pieces };
      this.painting = await Painting.start(host, upload, (choices) => this.painted(choices));
      this.preview.hide(true);
      this.paint.hidden = this.form.inert = true;
      this.message.textContent = "";
    } catch (error) {
      this.say(error);
    } finally {
      this.go.disabled = this.paint.disabled = false;
    }
  }

  /** Painting has ended, with choices if pieces have changed. */
  private painted(choices: PieceChoices | null): void {
    this.painting = null;
    this.paint.hidden = this.form.inert = false;
    this.preview.hide(false);
    if (choices) this.changing = this.change(choices);
    else void this.show();
    this.paint.focus();
  }

  private key(event: KeyboardEvent): void {
    if (!this.painting) return;
    if (event.key === "Escape") {
      event.preventDefault(); // ends painting, not the dialog
      this.painting.finish(false);
    } else if (!isTyping(event.target) && this.painting.key(event)) event.preventDefault();
    else return;
    event.stopPropagation();
  }

  /** Returns whether the import succeeded. */
  private async change(assumptions: Assumptions): Promise<boolean> {
    this.busy("Importing the mesh again");
    try {
      this.tree = await changeAssumptions(this.tree.id, assumptions);
      this.message.textContent = "";
      return true;
    } catch (error) {
      this.say(error);
      return false;
    } finally {
      this.go.disabled = false;
      await this.show();
    }
  }

  private async compute(): Promise<void> {
    this.painting?.finish(true);
    const fine = await this.changing;
    this.changing = Promise.resolve(true);
    if (!fine) return;
    this.busy("Submitting");
    try {
      await startBuild(this.tree.id, this.liveliness.settings);
      this.started = true;
      this.follow();
    } catch (error) {
      this.go.disabled = false;
      this.say(error);
    }
  }

  /** Shows the progress until the tree moves or the visitor closes the dialog. */
  private follow(): void {
    const { id } = this.tree;
    const computing = new Computing(displayName(this.tree), {
      cancel: () => {
        this.uploads.onCancel?.(id);
        this.dialog.close();
      },
      leave: () => this.dialog.close(),
    });
    this.computing = computing;
    this.paint.hidden = true;
    this.side.replaceChildren(computing.root);
    computing.focus();
    this.stopWatching = this.uploads.watch(id, (change) => {
      if (change) computing.update(change);
      else this.dialog.close();
    });
    this.uploads.add(id, true);
  }

  private busy(words: string): void {
    this.go.disabled = true;
    this.message.textContent = words;
  }

  private say(error: unknown): void {
    if (error instanceof Problem) this.message.textContent = `${error.title} ${error.hint}`;
    else this.message.textContent = error instanceof Error ? error.message : String(error);
  }

  private async closed(): Promise<void> {
    cancelAnimationFrame(this.frame);
    this.stopWatching();
    this.computing?.dispose();
    this.several?.dispose();
    this.painting?.dispose();
    this.preview.dispose();
    this.dialog.remove();
    this.started ||= this.several !== null; // which removes it if it was cancelled
    if (!this.started) await deleteTree(this.tree.id).catch(() => {}); // discarded
    this.settle(this.started);
  }
}

function list(name: string, texts: readonly string[]): HTMLElement[] {
  if (texts.length === 0) return [];
  const made = make("ul", "", name);
  made.append(...texts.map((words) => make("li", words)));
  return [made];
}

const isTyping = (target: EventTarget | null) =>
  target instanceof HTMLInputElement && /^(text|number)$/.test(target.type);
