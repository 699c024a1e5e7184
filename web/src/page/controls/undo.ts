/** Undo and redo of wind and settings, by button and keyboard. What others change in a shared forest is not undone. */
import { History } from "../settings/history";
import type { Settings } from "../settings/settings";
import type { Store } from "../store/store";
import { tool } from "./tools";

/** Whether a key press belongs to a text field, which has its own undo. */
const typing = (target: EventTarget | null) =>
  target instanceof HTMLTextAreaElement ||
  (target instanceof HTMLInputElement && /^(text|number|search|url|password)$/.test(target.type));

export class Undo {
  private readonly back = tool("undo", "Undo (Ctrl+Z)", () => this.replace(this.history.undo()));
  private readonly forth = tool("redo", "Redo (Ctrl+Y)", () => this.replace(this.history.redo()));
  readonly tools = [this.back, this.forth];
  private readonly history: History;

  constructor(private readonly store: Store) {
    this.history = new History(this.present);
    store.onChange((keys) => this.note(keys));
    addEventListener("keydown", (event) => this.key(event));
    this.offer();
  }

  private get present(): string {
    return JSON.stringify(this.store.settings);
  }

  private note(keys: readonly (keyof Settings)[]): void {
    if (this.store.isAdopting) this.history.adopt(this.present);
    else this.history.record(this.present, keys.join(), performance.now());
    this.offer();
  }

  private key(event: KeyboardEvent): void {
    const { key, shiftKey } = event;
    if (!(event.ctrlKey || event.metaKey) || event.altKey || typing(event.target)) return;
    const letter = key.toLowerCase();
    if (letter !== "z" && letter !== "y") return;
    event.preventDefault();
    this.replace(letter === "y" || shiftKey ? this.history.redo() : this.history.undo());
  }

  private replace(state: string | null): void {
    if (state === null) return;
    const then = JSON.parse(state) as Settings;
    const { settings } = this.store;
    const keys = (Object.keys(then) as (keyof Settings)[]).filter(
      (key) => JSON.stringify(then[key]) !== JSON.stringify(settings[key]),
    );
    this.store.change(Object.fromEntries(keys.map((key) => [key, then[key]])));
    this.offer();
  }

  /** Enables what is possible. */
  private offer(): void {
    this.back.disabled = !this.history.canUndo;
    this.forth.disabled = !this.history.canRedo;
  }
}
