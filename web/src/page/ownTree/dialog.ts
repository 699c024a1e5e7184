/** Shows the detected parts of an uploaded tree, ready to correct before its motion is computed. */
import "./ownTree.css";
import { readTreeModel } from "../../scene/treeModel/treeVariants";
import {
  type Assumptions,
  changeAssumptions,
  deleteTree,
  fetchMesh,
  knownSpecies,
  Problem,
  startPrecompute,
  type Tree,
} from "../server/api";
import type { Limits } from "../settings/queryNumbers";
import { make } from "../ui/dom";
import { displayName } from "../ui/words";
import { type Assumed, assumedOf, type Scan } from "./assumed";
import { Computing } from "./computing";
import { expectedMotionOf } from "./expectedMotion";
import { LivelinessChoice } from "./livelinessChoice";
import type { OwnUploads } from "./ownUploads";
import { AS_DETECTED, PieceList } from "./pieces";
import { Preview } from "./preview";

const AXES = { y: "Y", z: "Z", x: "X" };
const still = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

export class OwnTreeDialog {
  private readonly dialog = make("dialog", "", "own-tree");
  private readonly canvas = make("canvas", "", "own-tree-stage");
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
  private stopWatching = () => {};
  private started = false;
  private lacksWood = false;
  private frame = 0;
  private last_ms = 0;

  constructor(
    private tree: Tree,
    private readonly uploads: OwnUploads,
  ) {
    this.title.id = "own-tree-heading";
    this.dialog.setAttribute("aria-labelledby", this.title.id);
    this.message.setAttribute("role", "status");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Detected parts: wood in brown, leaves in green");
    const away = make("button", "Discard");
    for (const button of [away, this.go]) button.type = "button";
    away.addEventListener("click", () => this.dialog.close());
    this.go.addEventListener("click", () => void this.compute());
    const foot = make("footer");
    foot.append(away, this.go);
    this.side.append(this.form, this.message, foot);
    const body = make("div", "", "own-tree-body");
    body.append(this.canvas, this.side);
    this.dialog.append(this.title, body);
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
    this.form.replaceChildren(...this.fields(assumed, species), this.liveliness.root, ...warnings(assumed));
    if (!tree.mesh_sha256) return;
    try {
      const model = await readTreeModel(await fetchMesh(tree.mesh_sha256));
      this.preview.show(model, assumed.vertexPieces);
    } catch (error) {
      this.say(error);
    }
  }

  private fields(assumed: Assumed, species: readonly { id: string; name: string }[]): HTMLElement[] {
    const woods = Object.fromEntries(species.map(({ id, name }) => [id, name]));
    const wood = select(woods, assumed.species.value || "default", (value) =>
      this.change({ species: value }),
    );
    const height = numberField(assumed.height_m, { min: 0.5, max: 150, step: 0.1 }, (value) =>
      this.change({ height_m: value }),
    );
    const axis = select(AXES, assumed.axis.value, (value) => this.change({ up_axis: value }));
    return [
      row("Wood species", wood, assumed.species.reason),
      row("Height (m)", height, assumed.size),
      axisRow(axis, assumed),
      ...this.trees(assumed),
      ...this.addedWood(assumed),
      ...(assumed.scan ? this.scanFields(assumed.scan) : [this.parts(assumed)]),
    ];
  }

  /** Which tree of a file with several is imported. */
  private trees({ trees }: Assumed): HTMLElement[] {
    if (trees.length < 2) return [];
    const words = trees.map(({ number, height_m }) => [
      String(number),
      `${number} of ${trees.length}: ${height_m.toFixed(1)} m`,
    ]);
    const taken = trees.find((tree) => tree.taken)?.number ?? 1;
    const made = select(Object.fromEntries(words), String(taken), (value) =>
      this.change({ tree: Number(value), ...AS_DETECTED }),
    );
    return [row("Tree", made, "the file has several; drop it again to plant another one")];
  }

  /** Whether wood that the file lacks is added; the choice stays once wood has been left out. */
  private addedWood({ addedWood }: Assumed): HTMLElement[] {
    this.lacksWood ||= addedWood !== null;
    if (!this.lacksWood) return [];
    const made = select({ added: "Added", none: "None" }, addedWood === null ? "none" : "added", (value) =>
      this.change({ complete: value === "added" ? null : false }),
    );
    return [
      row(
        "Missing wood",
        made,
        addedWood ?? "foliage without wood stays rigid, or bends with the nearest bough",
      ),
    ];
  }

  /** What can be corrected only in a scanned tree. Its parts are known. */
  private scanFields({ dbh_cm, min_radius_mm, dropped, bare }: Scan): HTMLElement[] {
    const diameter = numberField(dbh_cm, { min: 1, max: 1500, step: 0.1 }, (value) =>
      this.change({ dbh_cm: value }),
    );
    diameter.disabled = dbh_cm === null;
    const least = numberField(min_radius_mm, { min: 0, max: 500, step: 0.5 }, (value) =>
      this.change({ min_radius_mm: value }),
    );
    const leaves = select({ added: "Added", none: "None" }, bare ? "none" : "added", (value) =>
      this.change({ bare: value === "none" }),
    );
    const low = "the trunk does not reach 1.3 m";
    return [
      row("Trunk (cm)", diameter, dbh_cm === null ? low : "diameter at 1.3 m; all radii are scaled with it"),
      row("Finest (mm)", least, `${dropped} dropped: branches nowhere as thick as this radius`),
      row("Leaves", leaves, "a scan has none; their area is assumed"),
    ];
  }

  /** The detected pieces; for reports of older imports their parts, each with a checkbox that marks it as wood. */
  private parts({ parts, pieces, trees }: Assumed): HTMLElement {
    if (pieces.length > 0) {
      this.pieces.show(pieces, trees.find((tree) => tree.taken)?.number ?? 1);
      return this.pieces.root;
    }
    const set = make("fieldset");
    set.append(make("legend", "Detected parts (checked = wood)"));
    for (const part of parts) {
      const box = make("input");
      Object.assign(box, { type: "checkbox", checked: part.wood, value: part.name, disabled: !part.name });
      box.addEventListener("change", () => {
        const chosen = [...set.querySelectorAll("input:checked")].map(
          (one) => (one as HTMLInputElement).value,
        );
        this.change({ wood_materials: chosen.length > 0 ? chosen : null });
      });
      const label = make("label");
      label.append(
        box,
        make("span", part.name || "unnamed"),
        make("small", `${part.faces.toLocaleString("en")} faces; ${part.reason}`),
      );
      set.append(label);
    }
    return set;
  }

  private async change(assumptions: Assumptions): Promise<void> {
    this.busy("Importing the mesh again");
    try {
      this.tree = await changeAssumptions(this.tree.id, assumptions);
      this.message.textContent = "";
    } catch (error) {
      this.say(error);
    } finally {
      this.go.disabled = false;
    }
    await this.show();
  }

  private async compute(): Promise<void> {
    this.busy("Submitting");
    try {
      await startPrecompute(this.tree.id, { first_frequency_hz: this.liveliness.firstFrequency_Hz });
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
    this.preview.dispose();
    this.dialog.remove();
    if (!this.started) await deleteTree(this.tree.id).catch(() => {}); // discarded
    this.settle(this.started);
  }
}

function warnings({ warnings: texts }: Assumed): HTMLElement[] {
  if (texts.length === 0) return [];
  const list = make("ul", "", "own-tree-warnings");
  list.append(...texts.map((words) => make("li", words)));
  return [list];
}

function axisRow(axis: HTMLElement, { axis: { reason, unsure } }: Assumed): HTMLElement {
  const made = row("Up axis", axis, unsure ? `Unsure, please check: ${reason}` : reason);
  made.classList.toggle("unsure", unsure);
  return made;
}

function row(words: string, control: HTMLElement, reason: string): HTMLElement {
  const label = make("label", "", "own-tree-row");
  label.append(make("span", words), control, make("small", reason));
  return label;
}

function numberField(
  value: number | null,
  limits: Limits,
  changed: (value: number | null) => void,
): HTMLInputElement {
  const made = make("input");
  const [min, max, step] = [limits.min, limits.max, limits.step].map(String);
  Object.assign(made, { type: "number", min, max, step, value: value?.toFixed(1) ?? "" });
  made.addEventListener("change", () =>
    changed(Number.isNaN(made.valueAsNumber) ? null : made.valueAsNumber),
  );
  return made;
}

function select(
  choices: Record<string, string>,
  value: string,
  chosen: (value: string) => void,
): HTMLSelectElement {
  const made = make("select");
  for (const [id, words] of Object.entries(choices)) {
    const option = make("option", words);
    option.value = id;
    made.append(option);
  }
  made.value = value;
  made.addEventListener("change", () => chosen(made.value));
  return made;
}
