/**
 * Progress cards, one for each tree whose table is being computed: the built-in trees, and the uploads that are planted
 * here. Only the owner of an upload can end its computation.
 */

import type { World } from "../forest/world";
import { onlyExtrasLeft } from "../paper/paperState";
import { isActive, type Job, pictureUrl, type Tree, type TreeChange } from "../server/api";
import type { Catalogue } from "../server/catalogue";
import { watch } from "../store/signals";
import { element, make, makeButton } from "../ui/dom";
import { displayName } from "../ui/words";
import { JobProgress } from "./jobProgress";

const FAREWELL_MS = 4000;
/** Longer, because there is something to press. */
const OWN_FAREWELL_MS = 20_000;
const PICTURES = { "tetrahedra.png": "Tetrahedral mesh", "skeleton.png": "Skeleton" };

export interface ProgressTools {
  /** Whether the tree's computation was started in this browser. */
  isOwn(id: string): boolean;
  /** Whether the tree is planted here. */
  isPlanted(id: string): boolean;
  show(id: string): void;
  plantMore(id: string): void;
  cancel(id: string): void;
  again(id: string): void;
  remove(id: string): void;
}

type Offer = "show" | "more" | "cancel" | "again" | "remove";

const OFFERS: Record<Offer, string> = {
  show: "Show my tree",
  more: "Plant more",
  cancel: "Cancel",
  again: "Try again",
  remove: "Remove",
};

interface Card {
  readonly root: HTMLElement;
  readonly job: JobProgress;
  readonly pictures: HTMLElement;
  readonly buttons: Readonly<Record<Offer, HTMLButtonElement>>;
  /** Whether its computation has ended. */
  over: boolean;
  leaving: ReturnType<typeof setTimeout>[];
}

export class ProgressCards {
  private readonly cards = new Map<string, Card>();

  constructor(
    private readonly tools: ProgressTools,
    catalogue: Catalogue,
    world: World,
  ) {
    catalogue.onChange((change) => this.update(change));
    watch(
      () => [world.placements.value],
      () => {
        for (const id of this.cards.keys()) if (world.forest.last(id)) this.offerView(id);
      },
    );
  }

  private update({ tree, job, deleted }: TreeChange): void {
    const own = this.tools.isOwn(tree.id);
    const concerned = tree.builtin || own || this.tools.isPlanted(tree.id);
    // The records of the paper's method and the bare table follow quietly once the table is complete.
    if (!deleted && concerned && isActive(job) && !onlyExtrasLeft(job)) this.compute(tree, job);
    else if (!deleted && job?.state === "failed") this.fail(tree.id, displayName(tree), job, own);
    else
      this.finish(tree.id, lastWords({ tree, job, deleted }), own && !deleted && tree.table_sha256 !== null);
  }

  /** The owner of a tree that is planted can be led to it. */
  private offerView(id: string): void {
    const card = this.cards.get(id);
    if (card && this.tools.isOwn(id) && this.tools.isPlanted(id)) card.buttons.show.hidden = false;
  }

  private card(id: string, name: string): Card {
    let card = this.cards.get(id);
    if (!card) {
      card = this.make(id, name);
      this.cards.set(id, card);
      element("progress").append(card.root);
    }
    return card;
  }

  private make(id: string, name: string): Card {
    const root = make("article", "", "card");
    const heading = make("h2", name);
    const job = new JobProgress(name);
    heading.append(job.percent);
    const pictures = make("div", "", "job-pictures");
    const row = make("div", "", "job-tools");
    const { tools } = this;
    const buttons = {
      show: offer("show", name, () => tools.show(id)),
      more: offer("more", name, () => tools.plantMore(id)),
      cancel: offer("cancel", name, () => tools.cancel(id)),
      again: offer("again", name, () => tools.again(id)),
      remove: offer("remove", name, () => tools.remove(id)),
    };
    row.append(...Object.values(buttons));
    root.append(heading, job.line, job.bar.root, row, pictures);
    return { root, job, pictures, buttons, over: false, leaving: [] };
  }

  private offer({ buttons }: Card, offers: readonly Offer[]): void {
    for (const name of Object.keys(OFFERS) as Offer[]) buttons[name].hidden = !offers.includes(name);
  }

  private compute(tree: Tree, job: Job): void {
    const { id } = tree;
    const name = displayName(tree);
    if (this.cards.get(id)?.over) this.drop(id);
    const known = this.cards.has(id);
    const card = this.card(id, name);
    card.job.show(job);
    card.buttons.cancel.hidden = !this.tools.isOwn(id);
    // In a shared forest the owner decides when it is planted for all; it must have a motion by then.
    const plantable = tree.table_sha256 !== null && !this.tools.isPlanted(id);
    card.buttons.more.hidden = !this.tools.isOwn(id) || !plantable;
    if (!known) this.offerView(id);
    this.showPictures(card, name, job);
  }

  /** Thumbnails of the pictures that the build has published so far, linked to the full size. */
  private showPictures({ pictures }: Card, name: string, job: Job): void {
    for (const [file, sha256] of Object.entries(job.pictures ?? {})) {
      if (!(file in PICTURES) || pictures.querySelector(`[data-name="${file}"]`)) continue;
      const link = make("a");
      const image = make("img");
      link.href = image.src = pictureUrl(job.id, file, sha256);
      link.target = "_blank";
      link.dataset.name = file;
      image.alt = `${PICTURES[file as keyof typeof PICTURES]} of ${name}`;
      link.append(image);
      pictures.append(link);
    }
  }

  /** Says why, and what to do. The owner's card stays until it is answered. */
  private fail(id: string, name: string, job: Job, own: boolean): void {
    if (!this.cards.has(id) && !own) return;
    const card = this.card(id, name);
    card.over = true;
    card.root.classList.add("failed");
    card.job.end(faultOf(job));
    card.job.percent.textContent = "failed";
    this.offer(card, own ? ["again", "remove"] : []);
    if (!own) this.leave(id, card, 3 * FAREWELL_MS);
  }

  private finish(id: string, words: string, own: boolean): void {
    const card = this.cards.get(id);
    if (!card || card.leaving.length > 0) return;
    card.over = true;
    card.job.end(words);
    card.job.bar.show(1);
    this.offer(card, own ? ["show", "more"] : []);
    this.leave(id, card, own ? OWN_FAREWELL_MS : FAREWELL_MS);
  }

  private leave(id: string, card: Card, after_ms: number): void {
    card.leaving = [
      setTimeout(() => card.root.classList.add("leaving"), after_ms),
      setTimeout(() => this.drop(id), after_ms + 700),
    ];
  }

  private drop(id: string): void {
    const card = this.cards.get(id);
    for (const timer of card?.leaving ?? []) clearTimeout(timer);
    card?.job.end("");
    card?.root.remove();
    this.cards.delete(id);
  }
}

function offer(name: Offer, tree: string, pressed: () => void): HTMLButtonElement {
  const button = makeButton(OFFERS[name], pressed);
  button.hidden = true;
  button.setAttribute("aria-label", `${OFFERS[name]}: ${tree}`);
  return button;
}

function lastWords({ tree, deleted }: TreeChange): string {
  if (deleted) return "Removed";
  if (tree.state === "ready") return "Complete: it moves by its full table";
  return tree.table_sha256 ? "Cancelled: it keeps the motion computed so far" : "Cancelled";
}

const WHAT_TO_DO = "Try again. If it fails again, upload the tree with another height or other wood parts.";

/** The fault of a job, with what to do about it. */
export function faultOf({ error }: Pick<Job, "error">): string {
  // The server's texts are a sentence about the fault and often one about the remedy.
  const advised = /[.!] \S/.test(error ?? "") ? "" : WHAT_TO_DO;
  return `${error ?? "The computation failed."} ${advised}`.trim();
}
