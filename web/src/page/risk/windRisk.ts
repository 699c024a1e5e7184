/** The wind risk of the stems of an inventory: computed by the service, shown as coloured dots and on cards. */
import { effect, signal } from "@preact/signals-core";
import { StemDots } from "../../scene/overlays/stemDots";
import { idOfStem, stemOf } from "../../scene/stand";
import type { Views } from "../camera/views";
import type { World } from "../forest/world";
import type { NamedInventory } from "../inventory/namedInventory";
import type { TreePicker } from "../picking/treePicker";
import { withServer } from "../server/connected";
import { fetchRisk, type RiskRequest, type StandRisk } from "../server/conversion";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { element, PHONE_PAGE } from "../ui/dom";
import { saveFile } from "../ui/saveFile";
import { colouringOf } from "./colourScale";
import { type ColouredBy, RiskCard } from "./riskCard";
import { StemCard } from "./stemCard";

const DOT_PX = 13;
const PHONE_DOT_PX = 9;

interface Found {
  readonly inventory: NamedInventory;
  readonly request: RiskRequest;
  readonly risk: StandRisk;
}

const isAbort = (error: unknown) => error instanceof DOMException && error.name === "AbortError";

function resultWords({ stems }: StandRisk, { foliage, speed_m_s }: RiskRequest): string {
  return `${stems.length} stems in a gust of ${speed_m_s} m/s, ${foliage === "leaf" ? "in leaf" : "bare"}.`;
}

export class WindRisk {
  readonly stemCard = new StemCard();
  private readonly card: RiskCard;
  private readonly dots = new StemDots(matchMedia(PHONE_PAGE).matches ? PHONE_DOT_PX : DOT_PX);
  private readonly found = signal<Found | null>(null);
  private readonly by = signal<ColouredBy>("critical");
  private running: AbortController | null = null;

  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly picker: TreePicker,
    private readonly views: Views,
  ) {
    world.stage.scene.add(this.dots.group);
    this.card = new RiskCard({
      calculate: () => {
        const { inventory } = this;
        if (inventory) void withServer("The wind risk was not calculated.", () => this.calculate(inventory));
      },
      cancel: () => this.running?.abort(),
      colour: (by) => {
        this.by.value = by;
      },
      select: (stem) => this.select(stem),
      save: () => void this.save(),
    });
    element("progress").after(this.card.root);
    const { state } = store;
    effect(() => {
      this.card.root.hidden = this.inventory === null;
    });
    watch(
      () => [state.inventory],
      () => this.forget(),
    );
    effect(() => this.showRisk());
    effect(() => this.showDots());
    effect(() => this.showStem());
  }

  private get inventory(): NamedInventory | null {
    const { inventory } = this.store.state;
    return inventory === "loading" ? null : inventory;
  }

  /** Another inventory is planted, or none. */
  private forget(): void {
    this.running?.abort();
    this.running = null;
    this.found.value = null;
    this.card.busy(false);
    this.card.say("");
  }

  /** Calculates as the card says, once for each call, also one that is made again when the server is back. */
  private async calculate(inventory: NamedInventory): Promise<void> {
    const { card } = this;
    const { request } = card;
    const running = new AbortController();
    this.running?.abort();
    this.running = running;
    card.busy(true);
    card.say(`Calculating ${inventory.stems.length} stems …`);
    let words = "";
    try {
      const answer = await fetchRisk(inventory.source, request, "json", running.signal);
      const risk = (await answer.json()) as StandRisk;
      if (this.inventory === inventory) {
        this.found.value = { inventory, request, risk };
        card.reveal();
      }
      words = resultWords(risk, request);
    } catch (error) {
      if (!isAbort(error)) throw error;
      words = "Cancelled.";
    } finally {
      if (this.running === running) {
        this.running = null;
        card.busy(false);
        card.say(words);
      }
    }
  }

  private showRisk(): void {
    this.card.show(this.found.value?.risk ?? null, this.by.value);
  }

  private showDots(): void {
    const found = this.found.value;
    const by = this.by.value;
    if (!found || by === "none") this.dots.hide();
    else this.dots.show(found.inventory.stems, colouringOf(found.risk, by).colours, this.selected);
  }

  /** The selected stem; null if no stem is selected. */
  private get selected(): number | null {
    const { selected } = this.picker;
    return selected && stemOf(selected.id);
  }

  private showStem(): void {
    const found = this.found.value;
    const stem = found && this.selected;
    this.stemCard.show(
      stem === null ? null : (found?.risk ?? null),
      stem ?? 0,
      found?.request.speed_m_s ?? 0,
    );
  }

  /** Selects the tree of a stem, and shows it. */
  private select(stem: number): void {
    const tree = this.world.forest.at(idOfStem(stem));
    if (!tree) return;
    this.picker.select(tree);
    this.views.showTree({ ...tree.position, height_m: tree.height_m });
    this.stemCard.root.scrollIntoView({ block: "nearest" });
  }

  private async save(): Promise<void> {
    const found = this.found.value;
    if (!found) return;
    const { inventory, request } = found;
    await withServer("The table was not saved.", async () => {
      const answer = await fetchRisk(inventory.source, request, "csv");
      saveFile(await answer.blob(), `${inventory.name.replace(/\.[^.]*$/, "")}-wind-risk.csv`);
    });
  }
}
