/** Progress cards, one for each tree whose table is being computed. */

import { onlyExtrasLeft } from "../paper/paperState";
import { isActive, type Job, pictureUrl, type TreeChange } from "../server/api";
import { element, make } from "./dom";
import { displayName, progressLine } from "./words";

const FAREWELL_MS = 4000;
const PICTURES = { "tetrahedra.png": "Tetrahedral mesh", "skeleton.png": "Skeleton" };

interface Card {
  readonly root: HTMLElement;
  readonly percent: HTMLElement;
  readonly line: HTMLElement;
  readonly bar: HTMLElement;
  readonly pictures: HTMLElement;
  leaving: boolean;
}

function makeCard(name: string): Card {
  const root = make("article", "", "card");
  const heading = make("h2", name);
  const percent = make("span");
  heading.append(percent);
  const line = make("p");
  const bar = make("div", "", "bar");
  bar.setAttribute("role", "progressbar");
  bar.setAttribute("aria-label", `Computing ${name}`);
  bar.setAttribute("aria-valuemin", "0");
  bar.setAttribute("aria-valuemax", "100");
  bar.append(make("i"));
  const pictures = make("div", "", "job-pictures");
  root.append(heading, line, bar, pictures);
  return { root, percent, line, bar, pictures, leaving: false };
}

export class ProgressCards {
  private readonly cards = new Map<string, Card>();

  update({ tree, job }: TreeChange): void {
    // The records of the paper's method and the bare table follow quietly once the table is complete.
    if (isActive(job) && !onlyExtrasLeft(job)) this.show(tree.id, displayName(tree), job);
    else if (job?.state === "failed") this.fail(tree.id, displayName(tree), job);
    else this.finish(tree.id, tree.state === "ready" ? "Added to the forest" : "Cancelled");
  }

  private card(id: string, name: string): Card {
    let card = this.cards.get(id);
    if (!card) {
      card = makeCard(name);
      this.cards.set(id, card);
      element("progress").append(card.root);
    }
    return card;
  }

  private show(id: string, name: string, job: Job): void {
    const card = this.card(id, name);
    const percent = Math.round(100 * Math.min(1, Math.max(0, job.fraction)));
    card.percent.textContent = job.state === "queued" ? "queued" : `${percent} %`;
    card.line.textContent = progressLine(job);
    card.bar.setAttribute("aria-valuenow", String(percent));
    (card.bar.firstElementChild as HTMLElement).style.transform = `scaleX(${percent / 100})`;
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

  private fail(id: string, name: string, job: Job): void {
    if (!this.cards.has(id)) return;
    const card = this.card(id, name);
    card.root.classList.add("failed");
    card.percent.textContent = "failed";
    card.line.textContent =
      typeof job.error === "string" ? job.error : (job.error?.title ?? "The computation failed.");
    this.leave(id, card, 3 * FAREWELL_MS);
  }

  private finish(id: string, words: string): void {
    const card = this.cards.get(id);
    if (!card || card.leaving) return;
    card.percent.textContent = "";
    card.line.textContent = words;
    (card.bar.firstElementChild as HTMLElement).style.transform = "none";
    this.leave(id, card, FAREWELL_MS);
  }

  private leave(id: string, card: Card, after_ms: number): void {
    card.leaving = true;
    setTimeout(() => card.root.classList.add("leaving"), after_ms);
    setTimeout(() => {
      card.root.remove();
      if (this.cards.get(id) === card) this.cards.delete(id);
    }, after_ms + 700);
  }
}
