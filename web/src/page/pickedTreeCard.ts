/** The card of the picked tree: what it shows, and what its buttons do. */
import type { Comparison } from "./compare/comparison";
import type { OwnTrees } from "./ownTree/ownTrees";
import type { PaperMethod } from "./paper/paperMethod";
import { cancelJob, Problem } from "./server/api";
import type { Catalogue } from "./server/catalogue";
import { plantedAs } from "./settings/planted";
import type { Settings } from "./settings/settings";
import type { TreePicker } from "./treePicker";
import { PickedCard } from "./ui/pickedCard";
import { showToast } from "./ui/toast";
import type { Visit } from "./visit";

interface CardParts {
  readonly settings: Settings;
  readonly picker: TreePicker;
  readonly catalogue: Catalogue;
  readonly paper: PaperMethod;
  readonly ownTrees: OwnTrees;
  readonly visit: Visit;
  readonly comparison: Comparison;
}

/** Cancels a computation; says why if that fails. */
async function cancel(jobId: string): Promise<void> {
  try {
    await cancelJob(jobId);
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    showToast(error.title, error.hint);
  }
}

export class PickedTreeCard {
  private readonly card: PickedCard;

  /** `menu`: the choice of what is drawn over trees. */
  constructor(
    menu: HTMLElement,
    private readonly page: CardParts,
  ) {
    const { settings, picker, ownTrees, visit, comparison } = page;
    this.card = new PickedCard(
      {
        follow: (following) => {
          picker.following = following;
        },
        compare: () => void comparison.open(),
        physics: () => visit.openPhysics(),
        cancel: (jobId) => void cancel(jobId),
        planted: (id) => plantedAs(settings, id),
        plant: (id, how) => ownTrees.plant(id, how),
        close: () => picker.select(null),
      },
      menu,
    );
  }

  /** Shows the tree that is picked, if any. */
  show(): void {
    const { picker, catalogue, paper } = this.page;
    const { figures } = picker;
    const known = figures && catalogue.find(figures.treeId);
    this.card.show(figures, known, known ? paper.stateOf(known) : { kind: "missing" });
  }

  dispose(): void {
    this.card.dispose();
  }
}
